// The glTF loader: transmission through infinitely thin walls, mirrors of index 0, and lamps that
// shine on both sides, by what is seen.
#include "load/expect_near.h"
#include "load/gltf_files.h"
#include "load/render_loaded.h"

namespace pt {
namespace {

/// Two by two texels whose red and blue have the mean 1/2 at their common corner.
std::string half_picture() {
  std::string bmp("BM\x46\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\2\0\0\0\2\0\0\0\1\0\x18\0", 30);
  bmp.resize(54);
  return bmp + std::string("\xff\0\xff\0\0\0\0\0\0\0\0\xff\0\xff\0\0", 16);
}

/// A square of the material in the plane z = 0, seen along its axis from z = 5 (or -5: from
/// behind), and at z = -4 (or 4) a black square that emits 1 towards it.
Loaded wall(const Json& material, bool from_behind = false, bool has_lamp = true) {
  GltfMaker maker;
  const int positions = maker.floats({-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0}, "VEC3");
  const int uvs = maker.floats({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2");
  const int indices = maker.indices<std::uint16_t>({0, 1, 2, 0, 2, 3});
  for (const int m : {0, 1}) {
    maker.mesh({{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}},
                {"indices", indices},
                {"material", m}});
  }
  Json black = {
      {"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0, 1}}, {"metallicFactor", 0}}},
      {"emissiveFactor", {1, 1, 1}},
      {"extensions", {{"KHR_materials_ior", {{"ior", 1}}}}}};
  maker.root["materials"] = {material, black};
  maker.root["images"] = {{{"uri", "data:image/bmp;base64," + base64(half_picture())}}};
  maker.root["textures"] = {{{"source", 0}}};
  maker.root["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 0.002}, {"znear", 0.1}}}}};
  const Json turned = {0, 1, 0, 0};  // half a turn about y
  Json lamp = {{"mesh", 1}, {"translation", {0, 0, from_behind ? 4 : -4}}};
  Json camera = {{"camera", 0}, {"translation", {0, 0, from_behind ? -5 : 5}}};
  if (from_behind) lamp["rotation"] = turned, camera["rotation"] = turned;
  maker.root["nodes"] = {{{"mesh", 0}}, camera};
  if (has_lamp) maker.root["nodes"].push_back(lamp);
  maker.root["scenes"][0]["nodes"] = {0, 1};
  if (has_lamp) maker.root["scenes"][0]["nodes"].push_back(2);
  return Loaded(maker);
}

Color seen(const Loaded& loaded, const Color& sky = Color(0.0f)) {
  SceneData scene = loaded.scene;
  scene.sky = {sky, sky};
  scene.environment = {};
  const ChannelMeans means = channel_means(scene, 8, 1024, 12);
  return {static_cast<float>(means.of[0].mean()), static_cast<float>(means.of[1].mean()),
          static_cast<float>(means.of[2].mean())};
}

/// A smooth dielectric (metallic 0 unless said).
Json clear(double transmission, const Json& pbr = Json::object(),
           const Json& more = Json::object()) {
  Json material = {
      {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0}}},
      {"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", transmission}}}}}};
  material["pbrMetallicRoughness"].update(pbr);
  material["extensions"].update(more);
  return material;
}

// One wall passes 1 - F of what is behind it, with F = ((n - 1) / (n + 1))^2, times its base
// colour, what of it is dielectric and clear (KHR_materials_transmission, 'Transmission BTDF').
TEST(GltfWalls, OneWallPassesWhatItDoesNotReflect) {
  const Json texture = {{"index", 0}};
  const Json textured = {{"KHR_materials_transmission",
                          {{"transmissionFactor", 1}, {"transmissionTexture", texture}}}};
  const auto ior = [](double n) { return Json{{"KHR_materials_ior", {{"ior", n}}}}; };
  struct Case {
    const char* name;
    Json material;
    Color expected;
  };
  const Case cases[] = {
      {"clear", clear(1), Color(0.96f)},
      {"tinted", clear(1, {{"baseColorFactor", {0.5, 0.25, 1, 1}}}), {0.48f, 0.24f, 0.96f}},
      {"half", clear(0.5), Color(0.48f)},
      {"metal", clear(1, {{"metallicFactor", 1}}), Color(0.0f)},
      {"quarter metal", clear(1, {{"metallicFactor", 0.25}}), Color(0.72f)},
      {"half of half", clear(0.5, {{"metallicFactor", 0.5}}), Color(0.24f)},
      {"textured", clear(1, Json::object(), textured), Color(0.48f)},
      {"textured in half metal", clear(1, {{"metallicFactor", 0.5}}, textured), Color(0.24f)},
      {"textured metal", clear(1, {{"metallicFactor", 1}, {"metallicRoughnessTexture", texture}}),
       Color(0.48f)},
      {"both textured",
       clear(1, {{"metallicFactor", 1}, {"metallicRoughnessTexture", texture}}, textured),
       Color(0.24f)},
      {"water", clear(1, Json::object(), ior(1.33)), Color(0.97994f)},
      {"no index", clear(1, Json::object(), ior(1)), Color(1.0f)},
      {"mirror", clear(1, Json::object(), ior(0)), Color(0.0f)},
      {"thickness 0",
       clear(1, Json::object(), {{"KHR_materials_volume", {{"thicknessFactor", 0}}}}),
       Color(0.96f)},
      {"thickness of its own",
       clear(1, Json::object(),
             {{"KHR_materials_volume",
               {{"attenuationDistance", 0.1}, {"attenuationColor", {0.1, 0.1, 0.1}}}}}),
       Color(0.96f)},
      {"half specular",
       clear(1, Json::object(), {{"KHR_materials_specular", {{"specularFactor", 0.5}}}}),
       Color(0.98f)}};
  for (const auto& [name, material, expected] : cases) {
    SCOPED_TRACE(name);
    const Loaded loaded(wall(material));
    expect_near(seen(loaded), expected, 0.015f);
    // Through what reflects all nothing is seen, so that the scene gets default lighting.
    EXPECT_EQ(loaded.messages.size(), loaded.count("default lighting"))
        << testing::PrintToString(loaded.messages);
    expect_near(seen(wall(material, true)), expected, 0.015f);  // culled by no one
  }
}

// A rough wall scatters what passes, and loses none of it under a sky of one colour.
TEST(GltfWalls, RoughWallsScatter) {
  const Loaded loaded = wall(clear(1, {{"roughnessFactor", 0.5}}), false, false);
  const MaterialDescription& m = loaded.scene.materials.at(loaded.scene.meshes.at(0).material);
  EXPECT_EQ(m.kind, kind_of<PrincipledThin>);
  EXPECT_EQ(m[&PrincipledThin::roughness].value.x, 0.5f);
  EXPECT_EQ(m[&PrincipledThin::spec_trans].value.x, 1.0f);
  EXPECT_FALSE(m.one_sided);
  expect_near(seen(loaded, Color(1.0f)), Color(1.0f), 0.03f);
}

TEST(GltfWalls, VolumesStaySolid) {
  const MaterialDescription m =
      wall(clear(1, Json::object(), {{"KHR_materials_volume", {{"thicknessFactor", 0.01}}}}))
          .scene.materials.at(0);
  EXPECT_EQ(m.kind, kind_of<Principled>);
  EXPECT_EQ(m[&Principled::spec_trans].value.x, 1.0f);
}

// KHR_materials_ior: an index of 0 makes Fresnel's term 1, times what KHR_materials_specular asks.
TEST(GltfWalls, AnIndexOfZeroReflectsAll) {
  const auto surface = [](const Json& color, const Json& more, double metallic = 0) {
    return Json{
        {"pbrMetallicRoughness",
         {{"baseColorFactor", color}, {"roughnessFactor", 0}, {"metallicFactor", metallic}}},
        {"extensions", more}};
  };
  const Json zero = {{"ior", 0}}, black = {0, 0, 0, 1}, grey = {0.5, 0.5, 0.5, 1};
  const auto with = [&](const Json& specular) {
    return Json{{"KHR_materials_ior", zero}, {"KHR_materials_specular", specular}};
  };
  struct Case {
    const char* name;
    Json material;
    Color expected;
  };
  const Case cases[] = {
      {"0", surface(grey, {{"KHR_materials_ior", zero}}), Color(1.0f)},
      {"coloured",
       surface(grey, with({{"specularColorFactor", {1, 0.5, 0.25}}})),
       {1, 0.5f, 0.25f}},
      {"factor", surface(black, with({{"specularFactor", 0.5}})), Color(0.5f)},
      {"dark", surface(black, with({{"specularColorFactor", {0.5, 0.25, 0}}})), {0.5f, 0.25f, 0}},
      {"none", surface(black, with({{"specularFactor", 0}})), Color(0.0f)},
      {"half metal", surface(grey, {{"KHR_materials_ior", zero}}, 0.5), Color(0.75f)},
      {"1000", surface(grey, {{"KHR_materials_ior", {{"ior", 1000}}}}), Color(0.997f)}};
  for (const auto& [name, material, expected] : cases) {
    SCOPED_TRACE(name);
    const Loaded loaded = wall(material, false, false);
    EXPECT_TRUE(loaded.messages.size() <= 1) << testing::PrintToString(loaded.messages);
    expect_near(seen(loaded, Color(1.0f)), expected, 0.01f);
  }
  const auto index_of = [&](const Json& ior) {
    return wall(surface(grey, {{"KHR_materials_ior", {{"ior", ior}}}}))
        .scene.materials.at(0)[&Principled::eta]
        .value.x;
  };
  EXPECT_EQ(index_of(1), 1.001f);  // at 1 metals would reflect nothing
  EXPECT_EQ(index_of(1.5), 1.5f);
  EXPECT_EQ(index_of(2.42), 2.42f);
  EXPECT_EQ(index_of(-1), 1.5f);
  EXPECT_EQ(index_of(0.9), 1.5f);
}

// Emission is seen on both sides where the material is double sided (specification, section 3.9.4).
TEST(GltfWalls, DoubleSidedLampsShineOnBothSides) {
  const auto lamp = [](bool both, const Json& more = Json::object()) {
    Json material = {
        {"emissiveFactor", {1, 0.5, 0.25}},
        {"doubleSided", both},
        {"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0, 1}}, {"metallicFactor", 0}}},
        {"extensions", {{"KHR_materials_ior", {{"ior", 1}}}}}};
    material.update(more);
    return material;
  };
  const Color full(1, 0.5f, 0.25f);
  expect_near(seen(wall(lamp(true), false, false)), full);
  expect_near(seen(wall(lamp(true), true, false)), full);
  expect_near(seen(wall(lamp(false), false, false)), full);
  expect_near(seen(wall(lamp(false), true, false)), Color(0.0f));
  EXPECT_EQ(wall(lamp(true), false, false).count("doubleSided"), 0u);
  // A veil of alpha 0.36 shows 0.36 of what it emits and 0.64 of what is behind it.
  const Json veil = lamp(true, {{"alphaMode", "BLEND"},
                                {"pbrMetallicRoughness",
                                 {{"baseColorFactor", {0, 0, 0, 0.36}}, {"metallicFactor", 0}}}});
  for (const bool behind : {false, true}) {
    expect_near(seen(wall(veil, behind)), 0.36f * full + Color(0.64f), 0.02f);
  }
  // Unlit materials are lamps here.
  const Json unlit = {{"doubleSided", true},
                      {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 1, 1}}}},
                      {"extensions", {{"KHR_materials_unlit", Json::object()}}}};
  for (const bool behind : {false, true}) {
    expect_near(seen(wall(unlit, behind, false)), {0.5f, 0.25f, 1});
  }
  EXPECT_EQ(wall(clear(1, Json::object())).count("front side only"), 0u);
  Json glowing = clear(1);
  glowing["emissiveFactor"] = {1, 1, 1}, glowing["doubleSided"] = true;
  EXPECT_EQ(wall(glowing).count("transmissive: light from the front side only"), 1u);
}

// A mesh that is used twice is a group, with its other side in it.
TEST(GltfWalls, InstancesOfDoubleSidedLampsHaveTwoSides) {
  GltfMaker maker = with_material({{"emissiveFactor", {1, 1, 1}}, {"doubleSided", true}});
  maker.root["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {9, 0, 0}}}};
  maker.root["scenes"][0]["nodes"] = {0, 1};
  const Loaded loaded(maker);
  ASSERT_EQ(loaded.scene.meshes.size(), 2u);
  EXPECT_EQ(loaded.scene.meshes[0].group, 1u);
  EXPECT_EQ(loaded.scene.meshes[1].group, 1u);
  EXPECT_EQ(loaded.scene.instances.size(), 2u);
}

// With T of transmission and m of metal, T (1 - m) is clear, and of the rest m / (1 - T (1 - m))
// is metal.
TEST(GltfWalls, MetalHasItsShareUnderPartialTransmission) {
  const auto top_of = [](const Loaded& loaded) {
    return loaded.scene.materials.at(loaded.scene.meshes.at(0).material);
  };
  const auto metallic = [](const MaterialDescription& m) {
    return m[&Principled::metallic].value.x;
  };
  const Loaded both = wall(clear(0.5, {{"metallicFactor", 0.5}}));
  const MaterialDescription& of_both = top_of(both);
  ASSERT_EQ(of_both.node, MaterialNode::blend);
  EXPECT_FLOAT_EQ(of_both.scalar(0), 0.25f);
  const MaterialDescription& opaque = both.scene.materials.at(of_both.children[0]);
  EXPECT_EQ(opaque.kind, kind_of<Principled>);
  EXPECT_FLOAT_EQ(metallic(opaque), 2.0f / 3.0f);
  EXPECT_EQ(both.scene.materials.at(of_both.children[1]).kind, kind_of<PrincipledThin>);

  const Loaded all_clear = wall(clear(1, {{"metallicFactor", 0.25}}));
  const MaterialDescription& of_clear = top_of(all_clear);
  ASSERT_EQ(of_clear.node, MaterialNode::blend);
  EXPECT_FLOAT_EQ(of_clear.scalar(0), 0.25f);
  EXPECT_EQ(all_clear.scene.materials.at(of_clear.children[0]).kind, kind_of<PrincipledThin>);
  const MaterialDescription& metal = all_clear.scene.materials.at(of_clear.children[1]);
  EXPECT_EQ(metal.kind, kind_of<Principled>);
  EXPECT_EQ(metallic(metal), 1.0f);
}

}  // namespace
}  // namespace pt
