#include "common/accel/trace_cpu/traverse_cwbvh_avx2.h"
#include "common/accel/traverse_triangles.h"

namespace pt {

#ifdef __x86_64__

bool has_avx2() {
  static const bool has = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") &&
                          __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("popcnt");
  return has;
}

namespace {

template <class Query>
void traverse(const TriangleTree& tree, const Ray& ray, Query& query) {
  tree.instance_count > 0 ? traverse_cwbvh_avx2<true>(tree, ray, query)
                          : traverse_cwbvh_avx2<false>(tree, ray, query);
}

}  // namespace

#else

bool has_avx2() { return false; }

namespace {

template <class Query>
void traverse(const TriangleTree& tree, const Ray& ray, Query& query) {
  traverse_cwbvh<true>(tree, ray, query);
}

}  // namespace

#endif

Hit closest_triangle_avx2(const TriangleTree& tree, const Ray& ray, float t_min, float t_max) {
  ClosestTriangle query(t_min, t_max);
  traverse(tree, ray, query);
  return query.result();
}

bool any_triangle_avx2(const TriangleTree& tree, const Ray& ray, float t_min, float t_max) {
  AnyTriangle query(t_min, t_max);
  traverse(tree, ray, query);
  return query.result();
}

}  // namespace pt
