// What the CPU's builders promise: every triangle is found through boxes that contain it, however
// many threads build.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>
#include <limits>
#include <set>

#include "accel/check_tree.h"
#include "accel/instanced_meshes.h"
#include "accel/tree_kinds.h"
#include "common/accel/build/build_triangle_tree.h"
#include "common/accel/build/instance_tree.h"
#include "common/accel/build/mesh_triangles.h"
#include "common/accel/build/tree_statistics.h"
#include "common/error/error.h"

namespace pt {
namespace {

class Builders : public testing::TestWithParam<TreeKind> {};
INSTANTIATE_TEST_SUITE_P(Kinds, Builders, testing::ValuesIn(tree_kinds),
                         [](const auto& kind) { return std::string(kind.param.name); });

glm::dvec3 point_of(const Triangle& t, double b1, double b2) {
  return (1 - b1 - b2) * glm::dvec3(t.v0) + b1 * glm::dvec3(t.v1) + b2 * glm::dvec3(t.v2);
}

/// Points of a triangle: corners, edges, inside.
std::vector<glm::dvec3> points_of(const Triangle& t, TestRandom& random) {
  std::vector<glm::dvec3> points = {t.v0, t.v1, t.v2};
  for (int i = 0; i < 12; ++i) {
    double b1 = random.unit(), b2 = random.unit();
    if (b1 + b2 > 1) b1 = 1 - b1, b2 = 1 - b2;
    points.push_back(point_of(t, i % 3 == 0 ? 0 : b1, i % 3 == 1 ? 0 : b2));
  }
  return points;
}

/// Checks a tree without instances. Points between the corners are rounded, by less than boxes are
/// widened.
void check(const TriangleTreeData& tree, const Mesh& mesh, bool splits) {
  TreeWalk walk(tree);
  walk.walk(tree.root);
  EXPECT_LE(walk.depth, bvh_depth_max);
  EXPECT_EQ(walk.node_visits, std::vector<int>(walk.node_visits.size(), 1));
  const MeshTriangles triangles({&mesh, 1});
  std::vector<std::vector<const LeafPlace*>> leaves_of(triangles.count());
  std::vector<int> slot_visits(tree.triangles.size());
  for (const LeafPlace& leaf : walk.leaves) {
    std::set<std::uint32_t> ids;
    for (std::uint32_t slot = leaf.first; slot < leaf.first + leaf.count; ++slot) {
      ++slot_visits.at(slot);
      leaves_of.at(tree.triangles[slot].id).push_back(&leaf);
      EXPECT_TRUE(ids.insert(tree.triangles[slot].id).second) << "twice in a leaf";
    }
  }
  EXPECT_EQ(slot_visits, std::vector<int>(slot_visits.size(), 1));
  TestRandom random(9);
  for (std::uint32_t id = 0; id < triangles.count(); ++id) {
    ASSERT_TRUE(leaves_of[id].size() == 1 || (splits && leaves_of[id].size() > 1)) << id;
    for (const glm::dvec3& p : points_of(triangles[id], random)) {
      ASSERT_TRUE(std::any_of(leaves_of[id].begin(), leaves_of[id].end(),
                              [&](const LeafPlace* leaf) { return leaf->box.contains(p); }))
          << "triangle " << id << " at " << p.x << ' ' << p.y << ' ' << p.z;
    }
  }
}

TEST_P(Builders, EveryTriangleLiesInBoxesThatContainIt) {
  for (const MeshKind& kind : mesh_kinds) {
    for (const int count : {1, 2, 3, 4, 5, 9, 100, 3000}) {
      SCOPED_TRACE(testing::Message() << kind.name << ", " << count);
      const Mesh mesh = kind.make(count);
      check(GetParam().build({mesh}), mesh, GetParam().builder == TreeBuilder::sbvh);
      if (HasFatalFailure()) return;
    }
  }
}

TEST_P(Builders, TreesAreNotDeeperThanTraversalsExpect) {
  const Mesh mesh = make_geometric_series(140);
  check(GetParam().build({mesh}), mesh, GetParam().builder == TreeBuilder::sbvh);
}

TEST_P(Builders, LargeMeshes) {
  const Mesh mesh = make_soup(70'000, 0.2);
  check(GetParam().build({mesh}), mesh, GetParam().builder == TreeBuilder::sbvh);
}

template <class T>
std::string bytes(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

TEST_P(Builders, ThreadsDoNotChangeTheTree) {
  for (const bool needles : {false, true}) {
    const std::vector<Mesh> meshes = {needles ? make_needles(1000) : make_soup(70'000, 0.2)};
    const auto build = [&](std::size_t threads) {
      tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      const TriangleTreeData tree = GetParam().build(meshes);
      return bytes(tree.bvh2) + bytes(tree.cwbvh) + bytes(tree.triangles);
    };
    const std::string one = build(1);
    EXPECT_TRUE(one == build(3));
  }
}

TEST_P(Builders, SlotsCarryWhatTheMeshesSay) {
  std::vector<Mesh> meshes = {make_soup(40, 3), Mesh(), make_soup(20, 3, {1, 2, 3})};
  meshes[0].material = 7;
  meshes[0].normals.resize(meshes[0].positions.size(), {0, 0, 1});
  meshes[2].material = 8;
  meshes[2].uvs.resize(meshes[2].positions.size());
  const TriangleTreeData tree = GetParam().build(meshes);
  for (const Triangle& t : tree.triangles) {
    const bool first = t.id < 40;
    const Mesh& mesh = meshes[first ? 0 : 2];
    const TriangleIndices& indices = mesh.triangles[first ? t.id : t.id - 40];
    EXPECT_EQ(t.material, mesh.material);
    EXPECT_EQ(t.attributes, first ? TriangleAttributes::normals : TriangleAttributes::uvs);
    EXPECT_EQ(t.v0, mesh.positions[indices.v[0]]);
    EXPECT_EQ(t.v1, mesh.positions[indices.v[1]]);
    EXPECT_EQ(t.v2, mesh.positions[indices.v[2]]);
  }
}

TEST_P(Builders, NothingMakesAnEmptyTree) {
  EXPECT_TRUE(GetParam().build({}).is_empty());
  EXPECT_TRUE(GetParam().build({Mesh(), Mesh()}).is_empty());
  EXPECT_TRUE(GetParam().build({Mesh()}, {{3, {}}}).is_empty());
  EXPECT_EQ(GetParam().build({}).view().triangle_count, 0u);
}

std::vector<Mesh> grouped_meshes() {
  std::vector<Mesh> meshes = {make_soup(60, 3), make_soup(50, 3, {}, 2), make_soup(1, 3, {}, 3),
                              make_soup(30, 3, {}, 4), make_soup(20, 3, {}, 5)};
  meshes[1].group = 4, meshes[2].group = 2, meshes[3].group = 4, meshes[4].group = 9;
  return meshes;
}

TEST_P(Builders, EachGroupHasATreeAndEachInstanceAPlace) {
  const std::vector<Mesh> meshes = grouped_meshes();
  std::vector<Instance> instances = {{4, translate({20, 0, 0})}, {2, {}}, {4, scale({1, -2, 1})}};
  instances.push_back({77, {}});  // a group without meshes
  const TriangleTreeData tree = GetParam().build(meshes, instances);
  ASSERT_EQ(tree.groups.size(), 3u) << "0, 2, 4; the instances name no group 9";
  for (const GroupTree& group : tree.groups) {
    TreeWalk walk(tree);
    walk.walk(group.root);
    std::set<std::uint32_t> ids;
    for (const LeafPlace& leaf : walk.leaves) {
      for (std::uint32_t s = leaf.first; s < leaf.first + leaf.count; ++s) {
        EXPECT_GE(s, group.first_slot);
        EXPECT_LT(s, group.first_slot + group.slot_count);
        ids.insert(tree.triangles.at(s).id);
      }
    }
    std::set<std::uint32_t> expected;
    std::uint32_t id = 0;
    for (const Mesh& mesh : meshes) {
      for (std::size_t i = 0; i < mesh.triangles.size(); ++i, ++id) {
        if (mesh.group == group.group) expected.insert(id);
      }
    }
    EXPECT_EQ(ids, expected);
  }
  ASSERT_EQ(tree.instances.size(), 4u);
  std::set<std::uint32_t> numbers;
  for (const InstanceRecord& record : tree.instances) numbers.insert(record.index);
  EXPECT_EQ(numbers, (std::set<std::uint32_t>{0, 1, 2, 4})) << "the world comes last";
}

TEST_P(Builders, InstancesLieInTheTopTreesBoxes) {
  TestRandom random(12);
  std::vector<Instance> instances;
  for (int i = 0; i < 200; ++i) {
    instances.push_back({i % 2 ? 4u : 2u, translate(point_in_cube(random, 50)) *
                                              rotate(point_in_cube(random, 1), 77) *
                                              scale({1, 0.01f + random.unit(), -1})});
  }
  const TriangleTreeData tree = GetParam().build(grouped_meshes(), instances);
  TreeWalk walk(tree);
  walk.walk(tree.root);
  std::vector<int> seen(tree.instances.size());
  for (const LeafPlace& leaf : walk.leaves) {
    ASSERT_EQ(leaf.count, 1u);
    ++seen.at(leaf.first);
    const InstanceRecord& record = tree.instances[leaf.first];
    for (std::uint32_t s = record.first_slot; s < record.first_slot + record.slot_count; ++s) {
      const Vec3 v = tree.triangles[s].v1;
      const Vec3 p =
          record.index < instances.size() ? instances[record.index].to_world.point(v) : v;
      EXPECT_TRUE(leaf.box.contains(p));
    }
  }
  EXPECT_EQ(seen, std::vector<int>(201, 1));
}

// What the device puts behind the groups' nodes that it has built.
TEST_P(Builders, TheTopTreeCanBeNumberedFromAnyNode) {
  const InstancedMeshes world = make_instanced_meshes(40);
  const TriangleTreeData tree = GetParam().build(world.meshes, world.instances);
  const InstanceTree top =
      build_instance_tree(tree.groups, world.instances, GetParam().accel, tree.first_top_node);
  const auto expect_tail = [&](const auto& part, const auto& all, std::size_t first) {
    ASSERT_EQ(first + part.size(), all.size());
    EXPECT_EQ(std::memcmp(part.data(), all.data() + first, part.size() * sizeof(part[0])), 0);
  };
  if (!tree.bvh2.empty()) expect_tail(top.bvh2, tree.bvh2, tree.root);
  if (!tree.cwbvh.empty()) expect_tail(top.cwbvh, tree.cwbvh, tree.root);
  expect_tail(top.instances, tree.instances, 0);
}

TEST_P(Builders, SummariesGoThroughInstances) {
  Mesh mesh = make_soup(500, 3);
  const TriangleTreeData own = GetParam().build({mesh});
  const TreeSummary single = summarize(own);
  EXPECT_EQ(single.quality.slots, own.triangles.size());
  mesh.group = 1;
  const TreeSummary placed = summarize(GetParam().build({mesh}, {{1, {}}}));
  EXPECT_EQ(placed.quality.nodes, single.quality.nodes + 1);
  EXPECT_EQ(placed.quality.slots, single.quality.slots);
  EXPECT_EQ(placed.quality.leaves, single.quality.leaves);
  EXPECT_EQ(placed.quality.depth, single.quality.depth + 1);
  EXPECT_NEAR(placed.quality.nodes_per_ray, single.quality.nodes_per_ray + 1, 0.05);
  EXPECT_NEAR(placed.quality.triangles_per_ray, single.quality.triangles_per_ray, 0.05);
  // Two far apart: a ray that meets the box of both meets one of them rarely.
  const TreeSummary two =
      summarize(GetParam().build({mesh}, {{1, {}}, {1, translate({1000, 1000, 1000})}}));
  EXPECT_EQ(two.quality.nodes, placed.quality.nodes);
  EXPECT_LT(two.quality.nodes_per_ray, 1.2);
}

TEST(BuilderErrors, NameTheTriangleAndTheInstance) {
  const auto message = [](const std::vector<Mesh>& meshes, const std::vector<Instance>& instances) {
    try {
      build_triangle_tree(meshes, instances, {});
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  const auto expect = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  Mesh mesh = make_soup(30, 1);
  mesh.positions[3 * 17].y = std::numeric_limits<float>::quiet_NaN();
  expect(message({make_soup(1, 1), mesh}, {}), "mesh 1, triangle 17: vertex 51");
  mesh.positions[3 * 17].y = std::numeric_limits<float>::infinity();
  expect(message({mesh}, {}), "mesh 0, triangle 17: vertex 51");
  mesh.positions[3 * 17].y = 1e20f;
  expect(message({mesh}, {}), "mesh 0, triangle 17: vertex 51");
  mesh = make_soup(30, 1);
  mesh.triangles[5].v[2] = 90;
  expect(message({mesh}, {}), "mesh 0, triangle 5: vertex 90, expected less than 90");
  mesh = make_soup(3, 1);
  mesh.group = 1;
  expect(message({mesh}, {{1, {}}, {0, {}}}), "instance 1: of group 0");
  expect(message({mesh}, {{1, scale({1, 0, 1})}}), "instance 0: expected a transform");
}

TEST(BuilderErrors, BuildersOfTheDeviceAreRefused) {
  TreeOptions options;
  options.builder = TreeBuilder::hploc;
  const std::vector<Mesh> meshes = {make_soup(3, 1)};
  EXPECT_THROW(build_triangle_tree(meshes, {}, options), Error);
  EXPECT_THROW(check_builder(TreeBuilder::hploc, AccelKind::brute, true), Error);
  EXPECT_THROW(check_builder(TreeBuilder::hploc_reinsert, AccelKind::cwbvh, false), Error);
  EXPECT_NO_THROW(check_builder(TreeBuilder::hploc_reinsert, AccelKind::cwbvh, true));
  EXPECT_NO_THROW(check_builder(TreeBuilder::lbvh, AccelKind::bvh2, true));
  EXPECT_NO_THROW(check_builder(TreeBuilder::sbvh, AccelKind::brute, false));
}

}  // namespace
}  // namespace pt
