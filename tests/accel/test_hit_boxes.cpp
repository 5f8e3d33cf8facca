// No box test hides a hit: neither those that happen, nor those that the triangle test's bound
// admits and this machine's rounding does not make.
#include <gtest/gtest.h>

// The emulation comes before what it emulates.
// clang-format off
#include "emulated_gpu.h"
#include "common/accel/trace_cuda/cwbvh_step.cuh"
// clang-format on
#include "accel/hard_hits.h"
#include "accel/tree_kinds.h"
#include "common/accel/build/wide/encode_cwbvh.h"

namespace pt {
namespace {

/// What the GPU's step misses of the children there are.
std::uint32_t missed_by_step(const CwbvhNode& node, const CwbvhRay& ray, float t) {
  const NearPlanes planes = select_near_planes(ray.inverse);
  return missed_slots(load_cwbvh_words(&node), ray.origin, ray.inverse, planes, t) &
         node.used_mask();
}

/// The ray visits the box of a triangle that it meets at `t`, in both kinds of nodes, although all
/// behind is pruned already. A sibling's box decides where the wide node's grid lies.
testing::AssertionResult visits(const Triangle& v, const Ray& ray, float t, TestRandom& random) {
  const Bounds own = hit_bounds(v.v0, v.v1, v.v2);
  Bounds other = own;
  other.grow(ray.origin + (2.0f * random.unit() * t) * ray.direction);
  if (!intersect_box(make_slab_test_ray(ray), own.min, own.max, 0.0f, t).is_hit()) {
    return testing::AssertionFailure() << "bvh2, t " << t;
  }
  CwbvhChildren children;
  children.count = 2;
  children.bounds[0] = own, children.bounds[1] = other;
  children.triangles[0] = children.triangles[1] = 1;
  const CwbvhNode node = encode_cwbvh_node(children, assign_cwbvh_slots(children), 0, 0);
  const CwbvhRay wide = make_cwbvh_ray(ray);
  if (intersect_cwbvh_node(node, wide, 0.0f, t) != node.used_mask()) {
    return testing::AssertionFailure() << "cwbvh, t " << t;
  }
  if (missed_by_step(node, wide, t) != 0) {
    return testing::AssertionFailure() << "cwbvh on CUDA, t " << t;
  }
  return testing::AssertionSuccess();
}

/// Where a hit's box is, all of its boxes are: whichever contain the triangle's own.
TEST(HitError, NoBoxAroundATriangleHidesIt) {
  TestRandom random(81);
  std::uint64_t hits = 0;
  for (const MeshKind& kind : hard_mesh_kinds) {
    const Mesh mesh = kind.make(300);
    const TriangleTreeData brute = brute_kind.build({mesh});
    for (const RayRecord& record : hard_rays(mesh, 90).rays) {
      const Ray ray = record.ray();
      const TriangleRay prepared = make_triangle_ray(ray.origin, ray.direction);
      for (const Triangle& v : brute.triangles) {
        const TriangleHit hit = intersect_triangle(prepared, v.v0, v.v1, v.v2);
        if (!(hit.t > 0 && hit.t < infinite_distance)) continue;
        ++hits;
        ASSERT_TRUE(visits(v, ray, hit.t, random)) << kind.name;
      }
    }
  }
  EXPECT_GT(hits, 40000u);
}

/// The least t of a hit near `p`, a point of the triangle, that the bound admits; 0: none.
float least_admitted(const Triangle& v, const Ray& ray, const glm::dvec3& p) {
  const glm::dvec3 o(ray.origin), d(ray.direction);
  const glm::dvec3 bound = double{hit_error_distance} * glm::abs(p - o) +
                           glm::dvec3(hit_margin(triangle_bounds(v.v0, v.v1, v.v2)));
  double low = 0, high = HUGE_VAL;
  for (int i = 0; i < 3; ++i) {
    if (d[i] == 0 && std::abs(p[i] - o[i]) > bound[i]) return 0.0f;
    if (d[i] == 0) continue;
    const double at = (p[i] - o[i]) / d[i], by = std::abs(bound[i] / d[i]);
    low = std::max(low, at - by), high = std::min(high, at + by);
  }
  const float t = std::nextafterf(static_cast<float>(low), HUGE_VALF);
  return low > 0 && t <= high ? t : 0.0f;
}

/// Distances come out of rounding a few half ulps too small, seldom and on no machine by all that
/// the bound has room for. The box tests rely on nothing else, so they must let all of it pass.
TEST(HitError, NoBoxHidesWhatTheBoundAdmits) {
  TestRandom random(82);
  int tested = 0;
  for (const MeshKind& kind : hard_mesh_kinds) {
    const Mesh mesh = kind.make(300);
    const TriangleTreeData brute = brute_kind.build({mesh});
    const Target target(mesh);
    for (int i = 0; i < 4000; ++i) {
      const auto slot = random.below(static_cast<std::uint32_t>(brute.triangles.size()));
      const Triangle& v = brute.triangles[slot];
      const double b1 = random.uniform(0, 1), b2 = random.uniform(0, 1 - b1);
      const glm::dvec3 p =
          (1 - b1 - b2) * glm::dvec3(v.v0) + b1 * glm::dvec3(v.v1) + b2 * glm::dvec3(v.v2);
      const double distance = double{target.size()} * random.log_uniform(1e-3, 1e4);
      const Ray ray = ray_to(Vec3(p + distance * random.direction()), Vec3(p));
      const float t = least_admitted(v, ray, p);
      if (t == 0.0f) continue;
      ++tested;
      ASSERT_TRUE(visits(v, ray, t, random)) << kind.name;
    }
  }
  EXPECT_GT(tested, 30000);
}

/// And none is visited for nothing: where the CPU's test misses a box by more than tolerances, so
/// does the GPU's step.
TEST(HitError, StepsOnCudaVisitWhatTheCpuVisits) {
  TestRandom random(83);
  int missed = 0;
  for (int i = 0; i < 20000; ++i) {
    CwbvhChildren children;
    children.count = cwbvh_width;
    for (int c = 0; c < cwbvh_width; ++c) {
      const Vec3 low = Vec3(random.unit(), random.unit(), random.unit());
      children.bounds[c] = {low, low + 0.3f * Vec3(random.unit(), random.unit(), random.unit())};
      children.triangles[c] = 1;
    }
    const CwbvhNode node = encode_cwbvh_node(children, assign_cwbvh_slots(children), 0, 0);
    const Vec3 from = 3.0f * Vec3(random.direction());
    const CwbvhRay ray = make_cwbvh_ray(ray_to(from, children.bounds[0].center()));
    const std::uint32_t near = missed_by_step(node, ray, 4.0f);
    const std::uint32_t far = ~intersect_cwbvh_node(node, ray, 0.0f, 4.0f) & node.used_mask();
    EXPECT_LE(std::popcount(near ^ far), 1) << i;
    missed += std::popcount(near);
  }
  EXPECT_GT(missed, 20000);
}

}  // namespace
}  // namespace pt
