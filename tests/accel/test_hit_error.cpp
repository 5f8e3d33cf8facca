// A hit is a function of the ray and the triangle: no structure hides one. The bound on which that
// rests, and what follows from it, at rays and triangles made to break it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>

#include "accel/hard_hits.h"
#include "accel/tree_kinds.h"
#include "common/rays/trace_rays.h"

namespace pt {
namespace {

/// How many times as far as its bound a hit's point on the ray is from its point of the triangle,
/// along the worst axis. The float weights of the vertices may be off by 4 half ulps each.
double error_in_bounds(const Triangle& v, const Ray& ray, const TriangleHit& hit) {
  const double b1 = hit.b1, b2 = hit.b2, b0 = std::max(0.0, 1.0 - b1 - b2), sum = b0 + b1 + b2;
  const glm::dvec3 p =
      (b0 * glm::dvec3(v.v0) + b1 * glm::dvec3(v.v1) + b2 * glm::dvec3(v.v2)) / sum;
  const glm::dvec3 o(ray.origin), at = o + double{hit.t} * glm::dvec3(ray.direction);
  const Bounds box = triangle_bounds(v.v0, v.v1, v.v2);
  const double extent = max_abs(box.max - box.min);
  const glm::dvec3 margin(hit_margin(box));
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    const double bound = double{hit_error_distance} * std::abs(p[i] - o[i]) + margin[i] +
                         8.0 * double{half_ulp} * extent;
    worst = std::max(worst, std::abs(at[i] - p[i]) / bound);
  }
  return worst;
}

TEST(HitError, IsWithinItsBound) {
  double worst = 0;
  std::uint64_t hits = 0;
  for (const MeshKind& kind : hard_mesh_kinds) {
    const Mesh mesh = kind.make(300);
    const TriangleTreeData brute = brute_kind.build({mesh});
    for (const RayRecord& record : hard_rays(mesh, 120).rays) {
      const Ray ray = record.ray();
      const TriangleRay prepared = make_triangle_ray(ray.origin, ray.direction);
      for (const Triangle& t : brute.triangles) {
        const TriangleHit hit = intersect_triangle(prepared, t.v0, t.v1, t.v2);
        if (!(hit.t > 0)) continue;
        const double error = error_in_bounds(t, ray, hit);
        ASSERT_LE(error, 1.0) << kind.name << " t " << hit.t;
        worst = std::max(worst, error);
        ++hits;
      }
    }
  }
  EXPECT_GT(hits, 50000u);
  EXPECT_GT(worst, 0.1) << "the bound says nothing if it is this far from what happens";
}

/// Rays of a kind for a mesh of so many triangles; many more if PTEXP_LARGE_TESTS is set.
int rays_each() { return std::getenv("PTEXP_LARGE_TESTS") != nullptr ? 40000 : 500; }

void expect_same(const TriangleTreeData& a, const TriangleTreeData& b, const RaySet& rays,
                 const std::string& what) {
  const auto expected = trace_rays_cpu(a, rays, {}).hits, hits = trace_rays_cpu(b, rays, {}).hits;
  std::size_t different = 0, first = 0;
  for (std::size_t i = hits.size(); i-- > 0;) {
    if (std::memcmp(&hits[i], &expected[i], sizeof(HitRecord)) != 0) ++different, first = i;
  }
  EXPECT_EQ(different, 0u) << what << ": ray " << first << ", t " << hits[first].t << " and "
                           << expected[first].t << ", triangle " << hits[first].primitive << " and "
                           << expected[first].primitive;
}

class HardHits : public testing::TestWithParam<MeshKind> {};
INSTANTIATE_TEST_SUITE_P(Meshes, HardHits, testing::ValuesIn(hard_mesh_kinds),
                         [](const auto& kind) { return std::string(kind.param.name); });

TEST_P(HardHits, AreTheSameInEveryStructure) {
  for (const int count : {40, 3000}) {
    const Mesh mesh = GetParam().make(count);
    for (const RayType type : {RayType::closest, RayType::any}) {
      const RaySet rays = hard_rays(mesh, rays_each(), type);
      const TriangleTreeData expected = (count < 100 ? brute_kind : tree_kinds[0]).build({mesh});
      for (const TreeKind& kind : tree_kinds) {
        expect_same(expected, kind.build({mesh}), rays, kind.name);
      }
    }
  }
}

TEST_P(HardHits, AreTheSameInInstances) {
  Mesh mesh = GetParam().make(60), world = mesh;
  mesh.group = 1;
  const std::vector<Instance> instances = hard_instances(12);
  for (const RayType type : {RayType::closest, RayType::any}) {
    const RaySet rays = hard_rays(world, rays_each() / 5, type);
    const TriangleTreeData brute = brute_kind.build({world, mesh}, instances);
    for (const TreeKind& kind : tree_kinds) {
      expect_same(brute, kind.build({world, mesh}, instances), rays, kind.name);
    }
  }
}

}  // namespace
}  // namespace pt
