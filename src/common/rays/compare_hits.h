// How hits agree with reference hits.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/accel/ray_record.h"

namespace pt {

inline constexpr float hit_tolerance = 1e-5f;  ///< of t, relative

struct HitComparison {
  std::uint64_t same = 0;   ///< t within the tolerance and the same triangle
  std::uint64_t ties = 0;   ///< t within the tolerance, another triangle: an edge, or coincident
  std::uint64_t other = 0;  ///< both hit, t differs
  std::uint64_t missed = 0, invented = 0;  ///< only the reference hits, or only the hits do
  std::string first;  ///< what the first of the last three kinds is, in words; empty: there is none

  bool agrees() const { return other + missed + invented == 0; }
};

/// The same number of both, of the same type. Distances may differ by `resolution`, too: what
/// floats can say of positions.
HitComparison compare_hits(const std::vector<HitRecord>& hits,
                           const std::vector<HitRecord>& reference, float resolution = 0.0f);

/// Two ulps of the rays' largest coordinate.
float position_resolution(const std::vector<RayRecord>& rays);

}  // namespace pt
