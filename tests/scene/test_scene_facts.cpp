// What is told about a scene: numbers and lines, by value.
#include <gtest/gtest.h>

#include "common/scene/data/scene_data.h"
#include "common/scene/data/scene_facts.h"

namespace pt {
namespace {

std::uint64_t bytes_named(const SceneFacts& facts, const std::string& name) {
  for (const BufferSize& buffer : facts.memory)
    if (buffer.name == name) return buffer.size_bytes;
  return 0;
}

/// Has another number of each kind; not prepared.
SceneData scene_of_numbers() {
  SceneData scene;
  for (std::size_t i = 1; i <= 2; ++i) {
    Mesh& mesh = scene.meshes.emplace_back();
    mesh.positions.resize(10 * i), mesh.triangles.resize(4 * i);
    mesh.normals.resize(5), mesh.uvs.resize(7);
  }
  scene.instances.resize(3);
  for (int i = 0; i < 5; ++i) scene.add_material(MaterialDescription());
  for (int i = 0; i < 4; ++i) scene.add_sphere(Vec3(0.0f), 1, 0);
  for (int i = 0; i < 6; ++i) scene.add_quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0);
  scene.textures.resize(7), scene.texels.resize(1000);
  scene.lights.resize(2), scene.light_list.lights.resize(9);
  return scene;
}

TEST(SceneFacts, CountsAndBytes) {
  SceneData scene = scene_of_numbers();
  SceneFacts facts;
  describe_scene(scene, facts);
  EXPECT_EQ(facts.triangles, 12u) << "each once, whatever its instances";
  EXPECT_EQ(facts.meshes, 2u);
  EXPECT_EQ(facts.instances, 3u);
  EXPECT_EQ(facts.spheres, 4u);
  EXPECT_EQ(facts.quads, 6u);
  EXPECT_EQ(facts.materials, 5u);
  EXPECT_EQ(facts.textures, 7u);
  EXPECT_EQ(facts.lights, 11u);
  EXPECT_EQ(bytes_named(facts, "meshes"), 30u * 12 + 12u * 12 + 10u * 12 + 14u * 8);
  EXPECT_EQ(bytes_named(facts, "textures"), 1000u);
  EXPECT_EQ(bytes_named(facts, "lights"), 9u * sizeof(Light));
  EXPECT_EQ(facts.memory.size(), 3u) << "none of what is not there";
  EXPECT_EQ(facts.tree.nodes, 0u);
  scene.environment_map.width = 2;
  scene.environment_map.texels.resize(8);
  scene.corners.resize(12);
  scene.light_list.selection.resize(9);
  describe_scene(scene, facts);
  EXPECT_EQ(facts.lights, 12u) << "and the environment";
  EXPECT_EQ(bytes_named(facts, "environment"), 8 * sizeof(scene.environment_map.texels[0]));
  EXPECT_EQ(bytes_named(facts, "meshes"), 736 + 12 * sizeof(CornerAttributes));
  EXPECT_EQ(bytes_named(facts, "lights"), 9 * (sizeof(Light) + sizeof(AliasEntry)));
}

TEST(SceneFacts, TheLinesOfAScene) {
  SceneFacts facts;
  EXPECT_EQ(scene_text(facts), "") << "without triangles";
  facts.triangles = 1, facts.materials = 2, facts.lights = 1;
  EXPECT_EQ(scene_text(facts), "scene: 1 triangle, 2 materials, 1 light\n");
  facts.instances = 3, facts.spheres = 1, facts.textures = 4, facts.triangles = 5;
  facts.memory = {{"meshes", 123'449}, {"textures", 9'999'999}, {"lights", 10'000'000}};
  facts.tree = {"sah", 7, 9, 3, 12.345, 67.89, 9.96};
  EXPECT_EQ(scene_text(facts),
            "scene: 5 triangles, 3 instances, 1 sphere, 2 materials, 1 light, 4 textures\n"
            "memory: meshes 123.4 KB, textures 10000.0 KB, lights 10.0 MB\n"
            "tree: sah, 7 nodes, depth 3, SAH cost 12.3, 67.9 bytes per triangle, built in 10.0 "
            "ms\n");
  facts.tree.build_ms = 10.4;
  EXPECT_NE(tree_text(facts.tree).find("built in 10 ms"), std::string::npos);
}

TEST(SceneFacts, OfATree) {
  TreeSummary tree;
  tree.builder = "sbvh", tree.size_bytes = 1200, tree.build_ms = 3;
  EXPECT_EQ(tree_facts(tree, 10).builder, "") << "there is none";
  tree.quality.nodes = 4, tree.quality.slots = 11, tree.quality.depth = 2;
  tree.quality.nodes_per_ray = 5, tree.quality.triangles_per_ray = 3;
  const TreeFacts facts = tree_facts(tree, 10);
  EXPECT_EQ(facts.builder, "sbvh");
  EXPECT_EQ(facts.nodes, 4u);
  EXPECT_EQ(facts.references, 11u);
  EXPECT_EQ(facts.depth, 2);
  EXPECT_EQ(facts.sah_cost, 8);
  EXPECT_EQ(facts.bytes_per_triangle, 120);
  EXPECT_EQ(facts.build_ms, 3);
  EXPECT_EQ(tree_facts(tree, 0).bytes_per_triangle, 1200) << "no division by 0";
}

void expect_bounds(const Bounds& bounds, const Vec3& least, const Vec3& most) {
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(bounds.min[i], least[i], 1e-5f) << i;
    EXPECT_NEAR(bounds.max[i], most[i], 1e-5f) << i;
  }
}

TEST(SceneBounds, OfEachKindOfShape) {
  SceneData scene;
  EXPECT_TRUE(scene_bounds(scene).is_empty());
  scene.add_quad({1, 2, 3}, {4, 0, 0}, {0, 5, 0}, 0);
  expect_bounds(scene_bounds(scene), {1, 2, 3}, {5, 7, 3});
  scene.add_sphere({0, 0, 10}, 2, 0);
  expect_bounds(scene_bounds(scene), {-2, -2, 3}, {5, 7, 12});
  Mesh& mesh = scene.meshes.emplace_back();
  mesh.positions = {{20, 0, 4}, {21, 1, 5}};
  expect_bounds(scene_bounds(scene), {-2, -2, 3}, {21, 7, 12});
  mesh.group = 1;
  expect_bounds(scene_bounds(scene), {-2, -2, 3}, {5, 7, 12});
  Instance instance{1, {}};
  instance.to_world.row[2].w = -100;
  scene.instances = {instance};
  expect_bounds(scene_bounds(scene), {-2, -2, -96}, {21, 7, 12});
}

}  // namespace
}  // namespace pt
