// What the builder `best` takes, and what its predictor says.
#include <gtest/gtest.h>

#include "accel/tree_kinds.h"
#include "accel/triangle_rays.h"
#include "common/accel/build/binary/build_binary.h"
#include "common/accel/build/mesh_triangles.h"
#include "common/accel/build/tree_statistics.h"
#include "common/accel/build/try_splits.h"
#include "common/scene/builtin/generated_scenes.h"

namespace pt {
namespace {

/// Adds a closed box of 12 triangles, turned by `turn`.
void add_box(Mesh& mesh, const Vec3& half, const Affine& turn) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner(i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z);
    mesh.positions.push_back(turn.point(corner));
  }
  constexpr std::uint32_t sides[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                                         {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
  for (const auto& s : sides) {
    mesh.triangles.push_back({{first + s[0], first + s[1], first + s[2]}});
    mesh.triangles.push_back({{first + s[0], first + s[2], first + s[3]}});
  }
}

void add_mesh(Mesh& mesh, const Mesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const TriangleIndices& t : other.triangles) {
    mesh.triangles.push_back({{first + t.v[0], first + t.v[1], first + t.v[2]}});
  }
}

/// A room of 40 units with small spheres and long thin beams, across in all directions: their
/// boxes overlap each other and those of many small triangles.
Mesh make_beams(int beams) {
  TestRandom random(8);
  Mesh mesh;
  add_box(mesh, Vec3(20), {});
  for (int i = 0; i < beams; ++i) {
    const Affine turn = translate(point_in_cube(random, 14)) *
                        rotate(point_in_cube(random, 1), 360 * random.unit());
    add_box(mesh, {0.05f, 0.05f, static_cast<float>(random.uniform(1, 8))}, turn);
  }
  for (int i = 0; i < 30; ++i) {
    add_mesh(mesh, moved(make_closed_sphere(12), 0.1f, point_in_cube(random, 18)));
  }
  return mesh;
}

TriangleTreeData build(const std::vector<Mesh>& meshes, AccelKind accel, TreeBuilder builder,
                       const std::vector<Instance>& instances = {}) {
  return TreeKind{"", accel, builder}.build(meshes, instances);
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}
std::string all_bytes(const TriangleTreeData& tree) {
  return bytes_of(tree.bvh2) + bytes_of(tree.cwbvh) + bytes_of(tree.triangles);
}

double sah_cost(const TriangleTreeData& tree) {
  return summarize(tree).quality.sah_cost(
      static_cast<double>((tree.bvh2.empty() ? default_cwbvh_costs : default_bvh2_costs).triangle));
}

constexpr AccelKind structures[] = {AccelKind::bvh2, AccelKind::cwbvh};

/// Two leaves side by side.
BinaryTree make_pair(const Bounds& a, const Bounds& b) {
  BinaryTree tree;
  tree.nodes.reset(new Bvh2Node[1]);
  tree.node_capacity = 1;
  set_child_bounds(tree.nodes[0], 0, a), set_child_bounds(tree.nodes[0], 1, b);
  tree.nodes[0].child[0] = make_leaf(0, 1), tree.nodes[0].child[1] = make_leaf(1, 1);
  tree.order = {0, 1};
  tree.bounds = a;
  tree.bounds.grow(b);
  return tree;
}

TEST(OverlapShare, IsWhatBothVisitsCost) {
  const Bounds unit{Vec3(0), Vec3(1)};
  EXPECT_EQ(overlap_share(make_pair(unit, {{2, 0, 0}, {3, 1, 1}})), 0);
  // Apart along one axis alone, whichever it is.
  for (int axis = 0; axis < 3; ++axis) {
    Bounds other{Vec3(-1), Vec3(4)};
    other.min[axis] = 2, other.max[axis] = 3;
    EXPECT_EQ(overlap_share(make_pair(unit, other)), 0);
  }
  // The shared part is 0.5 x 1 x 1 (half area 2), the root 1.5 x 1 x 1 (4), each leaf 3.
  EXPECT_NEAR(overlap_share(make_pair(unit, {{0.5f, 0, 0}, {1.5f, 1, 1}})), 2.0 / (4 + 3 + 3),
              1e-6);
}

TEST(OverlapShare, GrowsByTheCostOfTheCheaperHalf) {
  // In the left half two boxes apart, in the right one a box; they share a unit cube (3).
  BinaryTree tree;
  tree.nodes.reset(new Bvh2Node[2]);
  tree.node_capacity = 2;
  const Bounds left{Vec3(0), {4, 1, 1}}, right{{3, 0, 0}, {4, 1, 1}};
  set_child_bounds(tree.nodes[0], 0, left), set_child_bounds(tree.nodes[0], 1, right);
  tree.nodes[0].child[0] = 1, tree.nodes[0].child[1] = make_leaf(2, 1);
  set_child_bounds(tree.nodes[1], 0, {Vec3(0), Vec3(1)});
  set_child_bounds(tree.nodes[1], 1, right);
  tree.nodes[1].child[0] = make_leaf(0, 1), tree.nodes[1].child[1] = make_leaf(1, 1);
  tree.order = {0, 1, 2};
  tree.bounds = left;
  // Visits: 9 for the root, 9 + 3 + 3 on the left, 3 on the right. A ray in the left half makes
  // 15 / 9 of them there, one in the right half makes one.
  EXPECT_NEAR(overlap_share(tree), 3.0 * 1 / (9 + 15 + 3), 1e-6);
}

TEST(BestBuilder, SplitsBeamsAcrossARoom) {
  const std::vector<Mesh> meshes = {make_beams(300)};
  for (const AccelKind accel : structures) {
    const TriangleTreeData tree = build(meshes, accel, TreeBuilder::best);
    EXPECT_EQ(tree.builder, "sbvh");
    EXPECT_TRUE(all_bytes(tree) == all_bytes(build(meshes, accel, TreeBuilder::sbvh)));
    EXPECT_LT(sah_cost(tree), 0.75 * sah_cost(build(meshes, accel, TreeBuilder::sah)));
  }
}

TEST(BestBuilder, LeavesARoomWholeAndReinsertsItsNodes) {
  const std::vector<Mesh> meshes = make_boxes_scene(1).meshes;
  for (const AccelKind accel : structures) {
    const TriangleTreeData tree = build(meshes, accel, TreeBuilder::best);
    EXPECT_EQ(tree.builder, "sah-reinsert");
    EXPECT_EQ(tree.triangles.size(), MeshTriangles(meshes).count());
    EXPECT_LT(sah_cost(tree), 0.96 * sah_cost(build(meshes, accel, TreeBuilder::sah)));
  }
}

TEST(BestBuilder, IsThatByReinsertionWhereSplitsAreNotTried) {
  for (const Mesh& mesh : {make_boxes_scene(1).meshes.front(), make_closed_sphere(40)}) {
    for (const AccelKind accel : structures) {
      const TriangleTreeData tree = build({mesh}, accel, TreeBuilder::sah_reinsert);
      EXPECT_TRUE(all_bytes(tree) == all_bytes(build({mesh}, accel, TreeBuilder::best)));
    }
  }
  const std::vector<Mesh> beams = {make_beams(300)};
  EXPECT_NE(build(beams, AccelKind::bvh2, TreeBuilder::sah_reinsert).builder, "sbvh");
}

TEST(BestBuilder, KeepsWhatReinsertionDoesNotImprove) {
  const std::vector<Mesh> meshes = {make_closed_sphere(40)};
  for (const AccelKind accel : structures) {
    const TriangleTreeData tree = build(meshes, accel, TreeBuilder::best);
    EXPECT_EQ(tree.builder, "sah");
    EXPECT_TRUE(all_bytes(tree) == all_bytes(build(meshes, accel, TreeBuilder::sah)));
  }
}

// The predictor says of both that splits may pay; rays say of which they do.
TEST(BestBuilder, TracesRaysToDecide) {
  const std::vector<Mesh> small = {make_soup(60'000, 0.3)}, large = {make_soup(20'000, 1)};
  for (const std::vector<Mesh>& meshes : {small, large}) {
    const MeshTriangles triangles(meshes);
    const BinaryTree whole =
        build_sah(triangles.count(), [&](std::uint32_t i) { return triangles.bounds(i); });
    EXPECT_GT(overlap_share(whole), 1.6);
  }
  for (const AccelKind accel : structures) {
    EXPECT_EQ(build(small, accel, TreeBuilder::best).builder.substr(0, 3), "sah");
    EXPECT_EQ(build(large, accel, TreeBuilder::best).builder, "sbvh");
  }
}

TEST(BestBuilder, DecidesForEachGroup) {
  std::vector<Mesh> meshes = {make_beams(300), make_closed_sphere(40)};
  meshes[0].group = 1, meshes[1].group = 2;
  const std::vector<Instance> instances = {{1, {}}, {2, translate({100, 0, 0})}};
  const TriangleTreeData tree = build(meshes, AccelKind::cwbvh, TreeBuilder::best, instances);
  EXPECT_EQ(tree.builder, "sah+sbvh");
  ASSERT_EQ(tree.groups.size(), 2u);
  EXPECT_GT(tree.groups[0].slot_count, meshes[0].triangles.size());
  EXPECT_EQ(tree.groups[1].slot_count, meshes[1].triangles.size());
}

TEST(BestBuilder, FindsWhatBruteForceFinds) {
  for (const bool is_split : {false, true}) {
    const std::vector<Mesh> meshes =
        is_split ? std::vector<Mesh>{make_beams(300)} : make_boxes_scene(1).meshes;
    const TriangleTreeData brute = brute_kind.build(meshes);
    Mesh all;
    for (const Mesh& mesh : meshes) add_mesh(all, mesh);
    const Target target(all);
    TestRandom random(3);
    for (const AccelKind accel : structures) {
      const TriangleTreeData tree = build(meshes, accel, TreeBuilder::best);
      ASSERT_EQ(tree.builder, is_split ? "sbvh" : "sah-reinsert");
      for (const RayKind& kind : ray_kinds) {
        for (int i = 0; i < 50; ++i) {
          const Ray ray = kind.make(target, random);
          const Hit found = closest_hit(tree, ray), expected = closest_hit(brute, ray);
          ASSERT_EQ(float_to_bits(found.t), float_to_bits(expected.t)) << kind.name << ' ' << i;
          if (expected.is_miss()) continue;
          EXPECT_EQ(tree.triangles[found.primitive].id, brute.triangles[expected.primitive].id);
        }
      }
    }
  }
}

}  // namespace
}  // namespace pt
