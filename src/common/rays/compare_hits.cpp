#include "common/rays/compare_hits.h"

#include <fmt/format.h>

#include <cmath>

namespace pt {
namespace {

std::string describe(const HitRecord& hit) {
  if (hit.t < 0.0f) return "a miss";
  if (hit.primitive == no_primitive) return "a hit";
  return fmt::format("triangle {} at {}", hit.primitive, hit.t);
}

}  // namespace

float position_resolution(const std::vector<RayRecord>& rays) {
  float largest = 0.0f;
  for (const RayRecord& ray : rays) largest = std::fmax(largest, max_abs(ray.origin));
  return 4.0f * half_ulp * largest;
}

HitComparison compare_hits(const std::vector<HitRecord>& hits,
                           const std::vector<HitRecord>& reference, float resolution) {
  HitComparison result;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const HitRecord &a = hits[i], &b = reference[i];
    const bool hit = !(a.t < 0.0f), expected = !(b.t < 0.0f);
    const bool same_t = std::fabs(a.t - b.t) <= hit_tolerance * std::fabs(b.t) + resolution;
    if (hit == expected && (same_t || !hit)) {
      ++(a.primitive == b.primitive ? result.same : result.ties);
      continue;
    }
    ++(hit && expected ? result.other : hit ? result.invented : result.missed);
    if (result.first.empty())
      result.first = fmt::format("ray {}: {}, expected {}", i, describe(a), describe(b));
  }
  return result;
}

}  // namespace pt
