#include "common/accel/traverse_brute_lanes.h"
#include "common/accel/traverse_triangles.h"

namespace pt {

#ifdef __x86_64__

namespace {

PT_AVX2 void closest_primitives(const Primitives& primitives, const RayBlock& rays,
                                HitBlock& hits) {
  closest_primitives_lanes<Lanes8>(primitives, rays, hits);
}
PT_AVX2 std::uint32_t any_primitive(const Primitives& primitives, const RayBlock& rays) {
  return any_primitives_lanes<Lanes8>(primitives, rays);
}
PT_AVX2 void closest_triangles(const TriangleTree& tree, const RayBlock& rays, HitBlock& hits) {
  closest_triangles_lanes<Lanes8>(tree, rays, hits);
}
PT_AVX2 std::uint32_t any_triangle(const TriangleTree& tree, const RayBlock& rays) {
  return any_triangles_lanes<Lanes8>(tree, rays);
}

}  // namespace

const BruteBlock* brute_block_avx2() {
  static constexpr BruteBlock lanes = {closest_primitives, any_primitive, closest_triangles,
                                       any_triangle};
  return has_avx2() ? &lanes : nullptr;
}

#else

const BruteBlock* brute_block_avx2() { return nullptr; }

#endif

}  // namespace pt
