#include "common/accel/lanes_avx512.h"
// clang-format off: behind it
#include "common/accel/traverse_brute_lanes.h"
// clang-format on

namespace pt {

#ifdef __x86_64__

namespace {

bool has_avx512() {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
         __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("bmi") &&
         __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("popcnt");
}

PT_LANES void closest_primitives(const Primitives& primitives, const RayBlock& rays,
                                 HitBlock& hits) {
  closest_primitives_lanes<Lanes16>(primitives, rays, hits);
}
PT_LANES std::uint32_t any_primitive(const Primitives& primitives, const RayBlock& rays) {
  return any_primitives_lanes<Lanes16>(primitives, rays);
}
PT_LANES void closest_triangles(const TriangleTree& tree, const RayBlock& rays, HitBlock& hits) {
  closest_triangles_lanes<Lanes16>(tree, rays, hits);
}
PT_LANES std::uint32_t any_triangle(const TriangleTree& tree, const RayBlock& rays) {
  return any_triangles_lanes<Lanes16>(tree, rays);
}

}  // namespace

const BruteBlock* brute_block_avx512() {
  static constexpr BruteBlock lanes = {closest_primitives, any_primitive, closest_triangles,
                                       any_triangle};
  static const bool has = has_avx512();
  return has ? &lanes : nullptr;
}

#else

const BruteBlock* brute_block_avx512() { return nullptr; }

#endif

}  // namespace pt
