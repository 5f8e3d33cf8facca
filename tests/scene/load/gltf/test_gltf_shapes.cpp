// The glTF loader: morph targets at their default weights, and skins where their joints are.
#include "load/expect_near.h"
#include "load/gltf_files.h"

namespace pt {
namespace {

GltfMaker with_target(const Json& mesh_weights) {
  GltfMaker maker;
  const int positions = maker.floats({0, 0, 0, 1, 0, 0, 0, 2, 0}, "VEC3");
  const int normals = maker.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  const int first = maker.floats({1, 0, 0, 0, 2, 0, 0, 0, 4}, "VEC3");
  const int second = maker.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  const int turned = maker.floats({0, 3, 0, 0, 3, 0, 0, 3, 0}, "VEC3");
  maker.mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}},
              {"targets", {{{"POSITION", first}, {"NORMAL", turned}}, {{"POSITION", second}}}}});
  if (!mesh_weights.is_null()) maker.root["meshes"][0]["weights"] = mesh_weights;
  return maker;
}

TEST(GltfShapes, MorphTargetsHaveTheirDefaultWeights) {
  const Mesh none = Loaded(with_target(nullptr)).scene.meshes.at(0);
  expect_near(none.positions[1], {1, 0, 0}, 0);
  expect_near(none.normals[0], {0, 0, 1}, 0);
  GltfMaker maker = with_target({0.5, 3});
  const Loaded loaded(maker);
  const Mesh both = loaded.scene.meshes.at(0);
  expect_near(both.positions[0], {0.5f, 0, 3});
  expect_near(both.positions[1], {1, 1, 3});
  expect_near(both.positions[2], {0, 2, 5});
  expect_near(both.normals[0], Vec3(0, 1.5f, 1) / std::sqrt(3.25f));
  EXPECT_EQ(loaded.count("morph"), 0u);
  // A node's weights count before the mesh's; missing ones are 0.
  maker.root["nodes"][0]["weights"] = {1};
  expect_near(Loaded(maker).scene.meshes.at(0).positions[2], {0, 2, 4});
  // Other weights are another shape: no instances of one.
  maker.root["nodes"].push_back({{"mesh", 0}});
  maker.root["scenes"][0]["nodes"] = {0, 1};
  const Loaded two(maker);
  EXPECT_TRUE(two.scene.instances.empty());
  ASSERT_EQ(two.scene.meshes.size(), 2u);
  maker.root["nodes"][0].erase("weights");
  EXPECT_EQ(Loaded(maker).scene.instances.size(), 2u);
}

TEST(GltfShapes, TargetsMayBeSparseAndOnlyThat) {
  GltfMaker maker = with_target({2.0});
  const int indices = maker.view(bytes_of<std::uint16_t>({1}));
  const int values = maker.view(bytes_of<float>({0, 0, 7}));
  const int target =
      maker.push("accessors", {{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
  maker.root["accessors"][target]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
      {"values", {{"bufferView", values}}}};
  maker.root["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", target}}};
  const Mesh mesh = Loaded(maker).scene.meshes.at(0);
  expect_near(mesh.positions[0], {0, 0, 0}, 0);
  expect_near(mesh.positions[1], {1, 0, 14}, 0);
}

TEST(GltfShapes, TargetsOfAnotherSizeAreAnError) {
  GltfMaker maker = with_target({1.0});
  maker.root["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] =
      maker.floats({0, 0, 0}, "VEC3");
  expect_error([&] { Loaded loaded(maker); },
               "targets[0].POSITION: 1 elements, but POSITION has 3");
}

/// The triangle with a skin of two joints, nodes 1 and 2, whose mesh's node is far away.
struct SkinMaker : GltfMaker {
  SkinMaker() {
    const int positions = floats({0, 0, 0, 1, 0, 0, 0, 2, 0}, "VEC3");
    const int normals = floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}});
    root["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {50, 0, 0}}},
                     {{"children", {2}}, {"translation", {0, 10, 0}}},
                     {{"translation", {0, 0, 5}}}};
    root["scenes"][0]["nodes"] = {0, 1};
    root["skins"] = {{{"joints", {1, 2}}}};
  }

  void set(const char* name, int accessor) {
    root["meshes"][0]["primitives"][0]["attributes"][name] = accessor;
  }
  void set_joints(std::initializer_list<std::uint8_t> joints, const char* name = "JOINTS_0") {
    set(name, accessor(view(bytes_of(joints)), 5121, 3, "VEC4"));
  }
  void set_bind(std::initializer_list<float> columns) {
    root["skins"][0]["inverseBindMatrices"] =
        accessor(view(bytes_of(columns)), 5126, columns.size() / 16, "MAT4");
  }
};

TEST(GltfShapes, SkinsArePlacedByTheirJoints) {
  SkinMaker maker;
  maker.set_joints({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0});
  maker.set("WEIGHTS_0", maker.floats({1, 0, 0, 0, 1, 0, 0, 0, 0.25f, 0.75f, 0, 0}, "VEC4"));
  const Loaded loaded(maker);
  ASSERT_EQ(loaded.scene.meshes.size(), 1u);
  const Mesh& mesh = loaded.scene.meshes[0];
  expect_near(mesh.positions[0], {0, 10, 0});
  expect_near(mesh.positions[1], {1, 10, 5});  // by its parent, too
  expect_near(mesh.positions[2], {0, 12, 3.75f});
  EXPECT_EQ(loaded.count("skin"), 0u);
}

// Mixamo's armature: joints in centimetres below a node of scale 0.01, undone by the inverse bind
// matrices, here with a turn of the second joint by 90 degrees about x.
TEST(GltfShapes, InverseBindMatricesUndoTheJointsAsTheyWereBound) {
  SkinMaker maker;
  const float h = std::sqrt(0.5f);
  maker.root["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"scale", {7, 7, 7}}},
                         {{"translation", {0, 100, 0}}, {"children", {2}}},
                         {{"translation", {0, 100, 0}}, {"rotation", {h, 0, 0, h}}},
                         {{"scale", {0.01, 0.01, 0.01}}, {"children", {1}}}};
  maker.root["scenes"][0]["nodes"] = {0, 3};
  // Bound where they are, but unturned: x -> 100 x - (0, 100 or 200, 0).
  maker.set_bind({100, 0, 0, 0, 0, 100, 0, 0, 0, 0, 100, 0, 0, -100, 0, 1,  //
                  100, 0, 0, 0, 0, 100, 0, 0, 0, 0, 100, 0, 0, -200, 0, 1});
  maker.set_joints({0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  maker.set("WEIGHTS_0", maker.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4"));
  const Mesh mesh = Loaded(maker).scene.meshes.at(0);
  expect_near(mesh.positions[0], {0, 0, 0});
  expect_near(mesh.positions[1], {1, 2, -2});  // (1, 0, 0) about (0, 2, 0): y - 2 = -2 -> z = -2
  expect_near(mesh.positions[2], {0, 2, 0});   // the joint itself
  expect_near(mesh.normals[0], {0, 0, 1});
  expect_near(mesh.normals[1], {0, -1, 0});
}

// Integers of which 255 is 1, weights whose sum is not 1, and a second set of joints.
TEST(GltfShapes, WeightsOfAllKinds) {
  SkinMaker maker;
  maker.set_joints({0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1});
  maker.set_joints({1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}, "JOINTS_1");
  const int bytes =
      maker.accessor(maker.view(bytes_of<std::uint8_t>({51, 204, 0, 0, 255, 0, 0, 0, 0, 0, 0, 0})),
                     5121, 3, "VEC4");
  maker.set("WEIGHTS_0", bytes);
  for (const bool normalized : {true, false}) {
    maker.root["accessors"][bytes]["normalized"] = normalized;
    const Mesh mesh = Loaded(maker).scene.meshes.at(0);
    expect_near(mesh.positions[0], {0, 10, 4});
    expect_near(mesh.positions[1], {1, 10, 0});
    expect_near(mesh.positions[2], {0, 12, 0});  // no weight at all: the first joint
  }
  maker.set("WEIGHTS_0", maker.floats({1, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4"));
  maker.set("WEIGHTS_1", maker.floats({2, 0, 0, 0, -0.5f, 0, 0, 0, 3, 0, 0, 0}, "VEC4"));
  const Mesh mesh = Loaded(maker).scene.meshes.at(0);
  expect_near(mesh.positions[0], {0, 10, 3.75f});
  expect_near(mesh.positions[1], {1, 10, 0});
  expect_near(mesh.positions[2], {0, 12, 3.75f});
}

TEST(GltfShapes, MirroredJointsKeepTheFront) {
  SkinMaker maker;
  maker.root["nodes"][1]["scale"] = {-1, 1, 1};
  maker.set_joints({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  maker.set("WEIGHTS_0", maker.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4"));
  const Mesh mesh = Loaded(maker).scene.meshes.at(0);
  const auto& t = mesh.triangles.at(0).v;
  const Vec3 n = glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                            mesh.positions[t[2]] - mesh.positions[t[0]]);
  EXPECT_GT(n.z, 0.0f);
  expect_near(mesh.normals[0], {0, 0, 1});
  expect_near(mesh.positions[1], {-1, 10, 0});
}

TEST(GltfShapes, TwoSkinsOfOneMeshAreTwoMeshes) {
  SkinMaker maker;
  maker.set_joints({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  maker.set("WEIGHTS_0", maker.floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4"));
  maker.root["nodes"].push_back({{"mesh", 0}, {"skin", 1}});
  maker.root["skins"].push_back({{"joints", {2}}});
  maker.root["scenes"][0]["nodes"] = {0, 1, 3};
  const Loaded loaded(maker);
  EXPECT_TRUE(loaded.scene.instances.empty());
  ASSERT_EQ(loaded.scene.meshes.size(), 2u);
  expect_near(loaded.scene.meshes[0].positions[0], {0, 10, 0});
  expect_near(loaded.scene.meshes[1].positions[0], {0, 10, 5});
}

TEST(GltfShapes, WhatASkinLacksIsReported) {
  SkinMaker maker;
  EXPECT_EQ(Loaded(maker).count("without JOINTS_0 and WEIGHTS_0: it is placed by its node"), 1u);
  expect_near(Loaded(maker).scene.meshes.at(0).positions[0], {50, 0, 0});
  maker.set_joints({0, 9, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  maker.set("WEIGHTS_0", maker.floats({1, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4"));
  EXPECT_EQ(Loaded(maker).count("joint 9, the skin has 2"), 1u);
  maker.set_joints({0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});  // as many as there are: one too far
  EXPECT_EQ(Loaded(maker).count("joint 2, the skin has 2: it moves nothing"), 1u);
  maker.root["skins"][0]["joints"] = {1, 77};
  EXPECT_EQ(Loaded(maker).count("a joint that is not in the scene"), 1u);
  expect_near(Loaded(maker).scene.meshes.at(0).positions[0], {50, 0, 0});
  maker.root["nodes"][0]["skin"] = 4;
  EXPECT_EQ(Loaded(maker).count("nodes[0].skin: skins[4] does not exist"), 1u);
}

}  // namespace
}  // namespace pt
