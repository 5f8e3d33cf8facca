// Splits references by a plane, cutting the triangles that it meets (Stich, Friedrich and Dietrich
// 2009, 'Spatial Splits in Bounding Volume Hierarchies').
#pragma once

#include <functional>
#include <span>

#include "common/accel/build/binary/partition_range.h"
#include "common/geometry/triangle.h"

namespace pt {

/// A triangle by its index, from several threads at once.
using TriangleOf = std::function<Triangle(std::uint32_t)>;

struct SpatialSplit {
  float cost = HUGE_VALF;  ///< as ObjectSplit::cost; infinite: none
  int axis = 0;
  float plane = 0;
  Box4 left_bounds, right_bounds;
  std::uint32_t left_count = 0, right_count = 0;
};

/// The best of 15 equidistant planes per axis.
SpatialSplit find_spatial_split(std::span<const BuildReference> references,
                                const ReferenceRange& range, const TriangleOf& triangle_of);

/// How many references the plane cuts: so many more there may be afterwards.
std::uint32_t count_cut(std::span<const BuildReference> references, const ReferenceRange& range,
                        const SpatialSplit& split);

/// Cuts references, or gives them to one side whole where that is cheaper, puts the additional ones
/// after `range` (where there must be room for them), and partitions. One side may be empty.
RangeHalves split_spatially(std::span<BuildReference> references, const ReferenceRange& range,
                            const SpatialSplit& split, const TriangleOf& triangle_of);

}  // namespace pt
