// Splits of a set of references into two: whole references by the binned surface area heuristic, or
// triangles cut by a plane.
#pragma once

#include <functional>
#include <span>

#include "common/accel/build/binary/build_reference.h"
#include "common/geometry/triangle.h"

namespace pt {

/// Which references go left: those whose centre lies in a bin below `bin` on `axis`.
struct ObjectSplit {
  float cost = HUGE_VALF;  ///< left area x left count + right area x right count; infinite: none
  int axis = 0;
  int bin = 0;
  int bin_count = 0;
  Box4 left_bounds, right_bounds;
};

/// Maps doubled centres to bins, monotonically.
class BinMapping {
 public:
  BinMapping(const Box4& centers, int bin_count);
  Int4 operator()(Float4 twice_center) const {
    const Float4 x = (twice_center - base_) * scale_;
    return __builtin_convertvector(min4(max4(x, Float4{}), last_), Int4);
  }
  /// Whether centres differ on an axis.
  bool is_flat(int axis) const { return scale_[axis] == 0.0f; }

 private:
  Float4 base_, scale_, last_;
};

/// The best split of `range` into two sets that are not empty.
ObjectSplit find_object_split(std::span<const BuildReference> references,
                              const ReferenceRange& range);

/// Reorders the references of `range` so that the left ones come first.
RangeHalves partition_references(std::span<BuildReference> references, const ReferenceRange& range,
                                 const ObjectSplit& split);

/// Two halves of equal count (the left one is larger by one if need be) along the widest axis:
/// always possible, and the shallowest tree that there is.
RangeHalves split_in_halves(std::span<BuildReference> references, const ReferenceRange& range);

// Spatial splits: a plane cuts the triangles that it crosses (Stich, Friedrich and Dietrich 2009,
// 'Spatial Splits in Bounding Volume Hierarchies').

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

/// The box of the triangle's part in `box`, widened by hit_margin but not beyond `box`: the margin
/// grows with the whole triangle, however small the part. Empty only where the triangle is further
/// away than that.
Bounds clipped_bounds(const Vec3 (&vertices)[3], const Bounds& box);

}  // namespace pt
