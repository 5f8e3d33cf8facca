// The glTF loader: what absorbs inside of glass.
#include <array>

#include "load/expect_near.h"
#include "load/gltf_files.h"
#include "load/render_loaded.h"

namespace pt {
namespace {

Json glass_with(const Json& volume, float transmission = 1) {
  return {{"extensions",
           {{"KHR_materials_transmission", {{"transmissionFactor", transmission}}},
            {"KHR_materials_volume", volume}}}};
}

const Json absorbing = {
    {"thicknessFactor", 0.1}, {"attenuationColor", {1, 0.5, 0.25}}, {"attenuationDistance", 2}};

TEST(GltfVolumes, TheColourIsWhatIsLeftAfterTheDistance) {
  const Loaded loaded(with_material(glass_with(absorbing)));
  ASSERT_EQ(loaded.scene.media.size(), 1u);
  const Medium& medium = loaded.scene.media[0];
  expect_near(transmittance(medium.extinction, 2), Color(1, 0.5f, 0.25f));
  expect_near(medium.extinction, Color(0, 0.346574f, 0.693147f));  // ln 2 / 2, ln 4 / 2
  EXPECT_EQ(medium.albedo, Color(0));
  const MaterialDescription& material = loaded.scene.materials.at(0);
  EXPECT_TRUE(material.is_boundary && !material.passes);
  EXPECT_EQ(material.media, (MediumBoundary{no_medium, 0}));
  EXPECT_EQ(loaded.count("KHR_materials_volume"), 0u);
}

TEST(GltfVolumes, ManyHaveNoMedium) {
  const auto media = [](const Json& material) {
    const Loaded loaded(with_material(material));
    EXPECT_EQ(loaded.scene.materials.at(0).is_boundary, !loaded.scene.media.empty());
    return loaded.scene.media.size();
  };
  const auto without = [](const char* key) {
    Json volume = absorbing;
    volume.erase(key);
    return glass_with(volume);
  };
  EXPECT_EQ(media(glass_with(absorbing)), 1u);
  EXPECT_EQ(media(without("thicknessFactor")), 0u);  // a thin wall
  EXPECT_EQ(media(without("attenuationDistance")), 0u);
  EXPECT_EQ(media(without("attenuationColor")), 0u);
  EXPECT_EQ(media(glass_with(absorbing, 0)), 0u);
  EXPECT_EQ(media({{"extensions", {{"KHR_materials_volume", absorbing}}}}), 0u);
}

TEST(GltfVolumes, BlackIsFinite) {
  Json volume = absorbing;
  volume["attenuationColor"] = {0, 0, 1};
  const Color extinction = Loaded(with_material(glass_with(volume))).scene.media.at(0).extinction;
  EXPECT_TRUE(std::isfinite(extinction.x));
  EXPECT_LT(transmittance(extinction, 2).x, 1e-5);
}

TEST(GltfVolumes, ABadDistanceAbsorbsNothing) {
  Json volume = absorbing;
  for (const double distance : {0.0, -1.0}) {
    volume["attenuationDistance"] = distance;
    const Loaded loaded(with_material(glass_with(volume)));
    EXPECT_TRUE(loaded.scene.media.empty());
    EXPECT_EQ(loaded.count("attenuationDistance"), 1u);
    EXPECT_EQ(loaded.scene.materials.at(0)[&Principled::spec_trans].value.x, 1.0f);
  }
}

/// A pane of thickness 2 across the camera's axis, with this material on both faces.
Loaded pane(const Json& material) {
  GltfMaker maker;
  const int positions = maker.floats({-3, -3, 1,  3,  -3, 1,  3, 3, 1,  -3, 3,  1,    // faces +z
                                      -3, -3, -1, -3, 3,  -1, 3, 3, -1, 3,  -3, -1},  // faces -z
                                     "VEC3");
  const int indices = maker.indices<std::uint16_t>({0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7});
  maker.mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"material", 0}});
  maker.root["materials"] = Json::array({material});
  maker.root["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 0.002}, {"znear", 0.1}}}}};
  maker.root["nodes"].push_back({{"camera", 0}, {"translation", {0, 0, 5}}});
  maker.root["scenes"][0]["nodes"] = {0, 1};
  return Loaded(maker);
}

// Under a white sky a pane shows what it reflects and what gets through, which is r of one face
// and the sums of what is reflected inside.
TEST(GltfVolumes, APaneAbsorbsByBeersLaw) {
  Json glass = glass_with(
      {{"thicknessFactor", 2}, {"attenuationColor", {1, 0.5, 0.25}}, {"attenuationDistance", 1.5}});
  glass["pbrMetallicRoughness"] = {{"roughnessFactor", 0}, {"metallicFactor", 0}};
  SceneData scene = pane(glass).scene;
  scene.sky = {Color(1), Color(1)};
  scene.environment = {};
  scene.delta_lights.clear(), scene.sun = {};
  const ChannelMeans means = channel_means(scene, 8, 1024);
  const double r = 0.04;
  for (int c = 0; c < 3; ++c) {
    const double t = std::pow(std::array{1.0, 0.5, 0.25}[static_cast<std::size_t>(c)], 2 / 1.5);
    const double entering = (1 - r) * (1 - r) / (1 - r * r * t * t);
    EXPECT_NEAR(means.of[c].mean(), r + entering * t + entering * r * t * t,
                5 * means.of[c].sigma() + 2e-3)
        << "channel " << c;
  }
}

// What is around a normal map is the boundary, not what is under it.
TEST(GltfVolumes, AMappedMaterialIsABoundary) {
  GltfMaker maker = with_material(glass_with(absorbing));
  const int uvs = maker.floats({0, 0, 1, 0, 0, 1}, "VEC2");
  maker.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = uvs;
  // A PPM would be no image of glTF; one texel of a BMP.
  std::string bmp("BM\x3a\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\1\0\0\0\1\0\0\0\1\0\x18\0", 30);
  bmp.resize(54);
  bmp += std::string("\xff\x80\x80\0", 4);
  maker.root["images"] = {{{"uri", "data:image/bmp;base64," + base64(bmp)}}};
  maker.root["textures"] = {{{"source", 0}}};
  maker.root["materials"][0]["normalTexture"] = {{"index", 0}};
  const Loaded loaded(maker);
  const MaterialDescription& material =
      loaded.scene.materials.at(loaded.scene.meshes.at(0).material);
  ASSERT_NE(material.node, MaterialNode::none);
  EXPECT_TRUE(material.is_boundary);
  EXPECT_EQ(material.media.inside, 0u);
}

}  // namespace
}  // namespace pt
