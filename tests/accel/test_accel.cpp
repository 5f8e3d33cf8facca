// The tree and the scan find exactly what testing every primitive finds: same distance, same
// number.
#include <gtest/gtest.h>

#include "accel/primitive_scenes.h"
#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/traverse_brute.h"
#include "common/accel/traverse_bvh2.h"

namespace pt {
namespace {

/// From anywhere in the scene or from inside or on a primitive, in any direction, along the axes,
/// in their planes, or aimed at silhouettes.
Ray random_ray(TestRandom& random, const SceneData& scene) {
  const bool is_far = scene.name == "far_from_the_origin";
  Vec3 origin = random_point(random, 12) + (is_far ? far_away : Vec3(0.0f));
  const auto pick_sphere = [&]() -> const Sphere& {
    return scene.spheres[random.below(static_cast<std::uint32_t>(scene.spheres.size()))];
  };
  const bool has_spheres = !scene.spheres.empty();
  if (has_spheres && random.bits() % 4 == 0) origin = pick_sphere().center;
  if (!scene.quads.empty() && random.bits() % 8 == 0) {
    origin = scene.quads[random.below(static_cast<std::uint32_t>(scene.quads.size()))].corner;
  }
  Vec3 direction = random_point(random, 1);
  if (has_spheres && random.bits() % 4 == 0) {
    const Sphere& sphere = pick_sphere();
    const Vec3 side = glm::cross(sphere.center - origin, direction);
    const float length = std::sqrt(glm::dot(side, side));
    if (length > 0) direction = sphere.center + (sphere.radius() / length) * side - origin;
  }
  const std::uint32_t zeros = random.bits() % 16;  // in a plane, along an axis, with either zero
  for (int i = 0; i < 3; ++i) {
    if (zeros < 8 && (zeros >> i & 1)) direction[i] = random.bits() % 2 ? 0.0f : -0.0f;
  }
  if (!(glm::dot(direction, direction) > 1e-20f)) direction = {0, -1, 0};
  return {origin, normalize(direction)};
}

/// The definition: every primitive, one after the other.
Hit closest_hit_plain(const Primitives& primitives, const Ray& ray) {
  Hit hit;
  for (std::uint32_t i = 0; i < primitives.sphere_count + primitives.quad_count; ++i) {
    keep_nearer(hit, primitive_distance(primitives, i, ray), i);
  }
  return hit;
}

void expect_same_hits(const SceneData& scene, int rays) {
  const Scene view = host_view(scene, 1, 1);
  TestRandom random(7);
  for (int i = 0; i < rays; ++i) {
    const Ray ray = random_ray(random, scene);
    const Hit plain = closest_hit_plain(view.primitives, ray);
    const Hit brute = closest_hit_brute(view.primitives, ray);
    ASSERT_EQ(brute.primitive, plain.primitive) << "scan, ray " << i << ", t " << plain.t;
    ASSERT_EQ(brute.t, plain.t) << "scan, ray " << i;
    const Hit tree = closest_hit_bvh2(view.bvh_nodes, view.primitives, ray);
    ASSERT_EQ(tree.primitive, plain.primitive) << "tree, ray " << i << ", t " << plain.t;
    ASSERT_EQ(tree.t, plain.t) << "tree, ray " << i;
    const auto some = static_cast<float>(random.log_uniform(1e-3, 100));
    for (const float distance : {some, plain.t, std::nextafter(plain.t, 1e9f), infinite_distance}) {
      const bool expected = plain.t < distance;
      ASSERT_EQ(any_hit_brute(view.primitives, ray, distance), expected) << "ray " << i;
      ASSERT_EQ(any_hit_bvh2(view.bvh_nodes, view.primitives, ray, distance), expected)
          << "ray " << i << ", distance " << distance;
    }
  }
}

class AccelOf : public testing::TestWithParam<SceneKind> {};
INSTANTIATE_TEST_SUITE_P(Kinds, AccelOf, testing::ValuesIn(scene_kinds),
                         [](const auto& kind) { return std::string(kind.param.name); });

TEST_P(AccelOf, TreeAndScanFindWhatTestingEachPrimitiveFinds) {
  for (const int count : {1, 2, 3, 4, 5, 8, 9, 33, 100, 5000}) {
    SCOPED_TRACE(testing::Message() << count << " primitives");
    expect_same_hits(make_random_scene(GetParam(), count), count < 1000 ? 15'000 : 1'500);
  }
}

struct Box {
  Vec3 min, max;
};

Box primitive_box(const Primitives& primitives, std::uint32_t i) {
  if (primitives.is_sphere(i)) {
    const Sphere& s = primitives.spheres[i];
    return {s.center - s.radius(), s.center + s.radius()};
  }
  const Quad& q = primitives.quad(i);
  const Vec3 p[4] = {q.corner, q.corner + q.edge_a, q.corner + q.edge_b,
                     q.corner + q.edge_a + q.edge_b};
  return {glm::min(glm::min(p[0], p[1]), glm::min(p[2], p[3])),
          glm::max(glm::max(p[0], p[1]), glm::max(p[2], p[3]))};
}

/// Checks a subtree and returns the box of its primitives.
Box check_child(const Scene& scene, std::uint32_t child, const Box& stored, int depth,
                std::vector<int>& seen) {
  Box box{Vec3(HUGE_VALF), Vec3(-HUGE_VALF)};
  const auto grow = [&](const Box& b) {
    box = {glm::min(box.min, b.min), glm::max(box.max, b.max)};
  };
  EXPECT_LE(depth, bvh_depth_max);
  if (is_leaf(child)) {
    const std::uint32_t first = leaf_first(child), last = first + leaf_count(child) - 1;
    EXPECT_EQ(scene.primitives.is_sphere(first), scene.primitives.is_sphere(last)) << "two kinds";
    for (std::uint32_t i = first; i <= last; ++i)
      ++seen.at(i), grow(primitive_box(scene.primitives, i));
  } else {
    const Bvh2Node& node = scene.bvh_nodes[child];
    for (int i = 0; i < 2; ++i) {
      const Vec4& xy = node.xy[i];
      const Box half{{xy.x, xy.z, node.z[2 * i]}, {xy.y, xy.w, node.z[2 * i + 1]}};
      grow(check_child(scene, node.child[i], half, depth + 1, seen));
    }
  }
  if (stored.min == unreachable_bounds().min) return box;  // the second child of a single leaf
  EXPECT_TRUE(glm::all(glm::lessThan(stored.min, box.min))) << "not wider than its content";
  EXPECT_TRUE(glm::all(glm::greaterThan(stored.max, box.max))) << "not wider than its content";
  return box;
}

TEST_P(AccelOf, TreeHoldsEveryPrimitiveOnceInBoxesThatContainIt) {
  for (const int count : {1, 2, 3, 8, 9, 100, 5000}) {
    SCOPED_TRACE(testing::Message() << count << " primitives");
    const SceneData scene = make_random_scene(GetParam(), count);
    std::vector<int> seen(scene.primitive_count());
    check_child(host_view(scene, 1, 1), 0, {Vec3(-HUGE_VALF), Vec3(HUGE_VALF)}, 0, seen);
    // A tree that is a single leaf has it twice, since the root must be an inner node.
    const Bvh2Node& root = scene.bvh_nodes.front();
    const bool single = scene.bvh_nodes.size() == 1 && root.child[0] == root.child[1];
    EXPECT_EQ(seen, std::vector<int>(seen.size(), single ? 2 : 1));
  }
}

// A scan may name a sphere that the ray just misses, but never lose one that it meets.
TEST(SphereCandidates, AreTheSpheresThatTheLineMeets) {
  TestRandom random;
  for (std::uint32_t count = 1; count <= 32; ++count) {
    std::vector<Sphere> spheres, scan;
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto r = static_cast<float>(random.uniform(1, 8));
      spheres.push_back({random_point(random, 10), r * r});
      scan.push_back({spheres.back().center, (r + 1e-4f) * (r + 1e-4f)});  // as a scene widens it
    }
    while (scan.size() % scan_group != 0) scan.push_back({Vec3(0.0f), -HUGE_VALF});
    const auto padded = static_cast<std::uint32_t>(scan.size());
    for (int i = 0; i < 500; ++i) {
      const Ray ray{random_point(random, 10), normalize(random_point(random, 1))};
      std::uint32_t met = 0, nearly_met = 0;
      for (std::uint32_t j = 0; j < count; ++j) {
        const glm::dvec3 oc = glm::dvec3(spheres[j].center) - glm::dvec3(ray.origin);
        const double off = glm::length(glm::cross(oc, glm::dvec3(ray.direction)));
        if (off < spheres[j].radius()) met |= 0x80000000u >> j;
        if (off < 1.002 * spheres[j].radius()) nearly_met |= 0x80000000u >> j;
      }
      const std::uint32_t found =
          sphere_candidates(scan.data(), 0u, padded, ProjectedRay(ray, Vec3(0.0f)));
      ASSERT_EQ(met & ~found, 0u) << "lost one of " << count;
      ASSERT_EQ(found & ~nearly_met, 0u) << "invented one of " << count;
    }
  }
}

}  // namespace
}  // namespace pt
