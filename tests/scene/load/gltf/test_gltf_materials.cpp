// The glTF loader: materials.
#include "common/texture/sample_texture.h"
#include "common/transport/mask.h"
#include "load/expect_near.h"
#include "load/gltf_files.h"

namespace pt {
namespace {

MaterialDescription material_of(const GltfMaker& maker) {
  const Loaded loaded(maker);
  return loaded.scene.materials.at(loaded.scene.meshes.at(0).material);
}

TEST(GltfMaterials, MetallicAndRoughnessArePrincipled) {
  GltfMaker maker = with_material({{"pbrMetallicRoughness",
                                    {{"baseColorFactor", {0.1, 0.2, 0.3, 1}},
                                     {"metallicFactor", 0.4},
                                     {"roughnessFactor", 0.5}}}});
  const MaterialDescription one_sided = material_of(maker);
  EXPECT_EQ(one_sided.kind, kind_of<Principled>);
  expect_near(one_sided.color(0), {0.1f, 0.2f, 0.3f});
  EXPECT_FLOAT_EQ(one_sided.scalar(1), 0.5f);
  EXPECT_FLOAT_EQ(one_sided.scalar(2), 0.4f);
  EXPECT_FLOAT_EQ(one_sided.scalar(4), 1.5f);
  EXPECT_TRUE(one_sided.one_sided);
  EXPECT_FALSE(one_sided.is_textured());
  maker.root["materials"][0]["doubleSided"] = true;
  EXPECT_FALSE(material_of(maker).one_sided);
}

TEST(GltfMaterials, TheDefaultMaterialIsRoughWhiteMetal) {  // so says the specification
  const MaterialDescription material = material_of(triangle_file());
  EXPECT_EQ(material.kind, kind_of<Principled>);
  EXPECT_EQ(material.color(0), Color(1.0f));
  EXPECT_EQ(material.scalar(1), 1.0f);
  EXPECT_EQ(material.scalar(2), 1.0f);
}

TEST(GltfMaterials, TransmissionIntoAVolumeIsGlass) {
  GltfMaker maker = with_material({{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 1, 1, 1}}}},
                                   {"extensions",
                                    {{"KHR_materials_transmission", {{"transmissionFactor", 0.4}}},
                                     {"KHR_materials_volume", {{"thicknessFactor", 0.1}}},
                                     {"KHR_materials_ior", {{"ior", 1.33}}}}}});
  const MaterialDescription water = material_of(maker);
  EXPECT_EQ(water.kind, kind_of<Principled>);
  EXPECT_FLOAT_EQ(water.scalar(3), 0.4f);
  EXPECT_FLOAT_EQ(water.scalar(4), 1.33f);
  expect_near(water.color(0), {0.5f, 1, 1});
  EXPECT_FALSE(water.one_sided);
}

TEST(GltfMaterials, CoatSheenAndSpecular) {
  const MaterialDescription m = material_of(with_material(
      {{"extensions",
        {{"KHR_materials_clearcoat", {{"clearcoatFactor", 0.7}, {"clearcoatRoughnessFactor", 0.2}}},
         {"KHR_materials_sheen", {{"sheenColorFactor", {0.2, 0.6, 0.1}}}},
         {"KHR_materials_specular", {{"specularFactor", 0.25}}}}}}));
  EXPECT_FLOAT_EQ(m.scalar(10), 0.7f);
  EXPECT_NEAR(m.scalar(11), (0.1 - 0.04) / 0.099, 1e-6);  // alpha is roughness squared
  EXPECT_FLOAT_EQ(m.scalar(7), 0.6f);
  const double eta = m.scalar(4);  // whose reflectance is a quarter of 0.04
  EXPECT_NEAR(std::pow((eta - 1) / (eta + 1), 2), 0.01, 1e-6);
}

TEST(GltfMaterials, SpecularColoursCount) {
  const MaterialDescription m = material_of(
      with_material({{"extensions",
                      {{"KHR_materials_specular",
                        {{"specularFactor", 0.5}, {"specularColorFactor", {0.2, 0.8, 0.4}}}}}}}));
  const double eta = m.scalar(4);
  EXPECT_NEAR(std::pow((eta - 1) / (eta + 1), 2), 0.04 * 0.5 * 0.8, 1e-6);
}

TEST(GltfMaterials, SpecularGlossinessIsDiffuse) {
  const MaterialDescription material = material_of(with_material(
      {{"extensions",
        {{"KHR_materials_pbrSpecularGlossiness", {{"diffuseFactor", {0.2, 0.4, 0.6, 1}}}}}}}));
  EXPECT_EQ(material.kind, kind_of<Diffuse>);
  expect_near(material.color(0), {0.2f, 0.4f, 0.6f});
}

TEST(GltfMaterials, ABackIsSeenWhereTheFileSaysSo) {
  for (const bool both : {false, true}) {
    const Json plain = {{"doubleSided", both}};
    Json glossy = plain;
    glossy["extensions"] = {{"KHR_materials_pbrSpecularGlossiness", Json::object()}};
    EXPECT_EQ(material_of(with_material(plain)).one_sided, !both);
    EXPECT_EQ(material_of(with_material(glossy)).one_sided, !both);
  }
}

// A material and what is said of it, once, and of what is beside it nothing.
TEST(GltfMaterials, WhatIsApproximatedIsSaid) {
  const auto extension = [](const char* name, const Json& members) {
    return Json{{"extensions", {{name, members}}}};
  };
  const Json picture = {{"index", 0}},
             lamp = {{"emissiveFactor", {1, 1, 1}}, {"doubleSided", true}};
  const auto with = [](Json all, const Json& more) {
    all.update(more);
    return all;
  };
  const char* specular = "KHR_materials_specular: its factor times the largest component";
  const Json transmission = extension("KHR_materials_transmission", {{"transmissionFactor", 1}});
  const std::tuple<Json, const char*, std::size_t> cases[] = {
      {extension("KHR_materials_unlit", Json::object()), "KHR_materials_unlit: black that emits",
       1},
      {Json::object(), "KHR_materials", 0},
      {extension("KHR_materials_pbrSpecularGlossiness", Json::object()),
       "KHR_materials_pbrSpecularGlossiness: diffuse in the diffuse colour is used", 1},
      {extension("KHR_materials_sheen", {{"sheenColorFactor", {1, 0, 0}}}),
       "KHR_materials_sheen: that of the principled BSDF", 1},
      {extension("KHR_materials_sheen", Json::object()), "KHR_materials_sheen", 0},
      {extension("KHR_materials_clearcoat", {{"clearcoatFactor", 1}}),
       "KHR_materials_clearcoat: the coat of the principled BSDF", 1},
      {extension("KHR_materials_clearcoat", Json::object()), "KHR_materials_clearcoat", 0},
      {extension("KHR_materials_specular", {{"specularFactor", 0.5}}), specular, 0},
      {extension("KHR_materials_specular", {{"specularColorFactor", {0.5, 0.5, 0.5}}}), specular,
       0},
      {extension("KHR_materials_specular", {{"specularColorFactor", {0.5, 0.5, 0.6}}}), specular,
       1},
      {extension("KHR_materials_specular", {{"specularTexture", picture}}), specular, 1},
      {extension("KHR_materials_specular", {{"specularColorTexture", picture}}), specular, 1},
      {lamp, "doubleSided", 0},
      {with(lamp, transmission),
       "doubleSided, emissive and transmissive: light from the front side only", 1},
      {with({{"doubleSided", true}}, transmission), "doubleSided", 0},
      {with(lamp, {{"alphaMode", "BLEND"},
                   {"emissiveTexture", {{"index", 1}}},
                   {"pbrMetallicRoughness", {{"baseColorTexture", picture}}}}),
       "doubleSided, emissive and BLEND with different textures", 1},
      {with(lamp, {{"alphaMode", "BLEND"},
                   {"emissiveTexture", picture},
                   {"pbrMetallicRoughness", {{"baseColorTexture", picture}}}}),
       "doubleSided", 0}};
  for (const auto& [material, message, count] : cases) {
    GltfMaker maker = with_material(material);
    std::string tga(18, '\0');  // 32 bits, one texel
    tga[2] = 2, tga[12] = 1, tga[14] = 1, tga[16] = 32, tga[17] = 8;
    maker.root["textures"] = {{{"source", 0}}, {{"source", 1}}};
    maker.root["images"] = {
        {{"uri", "data:image/png;base64," + base64(tga + std::string(4, '\x80'))}},
        {{"uri", "data:image/png;base64," + base64(tga + std::string(4, '\x40'))}}};
    EXPECT_EQ(Loaded(maker).count(message), count) << material << message;
  }
}

TEST(GltfMaterials, UnlitEmitsItsColour) {
  const Loaded loaded(
      with_material({{"pbrMetallicRoughness", {{"baseColorFactor", {0.2, 0.4, 0.6, 1}}}},
                     {"extensions", {{"KHR_materials_unlit", Json::object()}}}}));
  const MaterialDescription& material = loaded.scene.materials.at(0);
  expect_near(material.emission.radiance, {0.2f, 0.4f, 0.6f});
  EXPECT_TRUE(is_black(material.color(0)));
  EXPECT_TRUE(is_black(loaded.scene.sky.zenith));
}

TEST(GltfMaterials, EmissionHasAStrength) {
  const Loaded loaded(with_material(
      {{"emissiveFactor", {1, 0.5, 0.25}},
       {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}}}}));
  expect_near(loaded.scene.materials.at(0).emission.radiance, {8, 4, 2});
  EXPECT_EQ(loaded.count("no light"), 0u);
  EXPECT_TRUE(is_black(loaded.scene.sky.zenith));
}

TEST(GltfMaterials, EachKindOfApproximationIsReportedOnce) {
  const Json coat = {{"KHR_materials_clearcoat", {{"clearcoatFactor", 1}}}};
  GltfMaker maker = with_material({{"extensions", coat}});
  maker.root["materials"].push_back({{"name", "other"}, {"extensions", coat}});
  auto& primitives = maker.root["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  primitives[1]["material"] = 1;
  const Loaded loaded(maker);
  EXPECT_EQ(loaded.scene.materials.size(), 2u);
  EXPECT_EQ(loaded.count("materials[0]"), 1u);
  expect_error([&] { Loaded strict(maker, true); },
               "scene.gltf: materials[0]: KHR_materials_clearcoat");
}

/// A material whose base colour is a picture of two texels, of which the second has this alpha.
GltfMaker with_alpha(const Json& material, unsigned char alpha) {
  GltfMaker maker = with_material(material);
  std::string tga(18, '\0');  // true colour, 32 bits, from the foot
  tga[2] = 2, tga[12] = 2, tga[14] = 1, tga[16] = 32, tga[17] = 8;
  tga += std::string{10, 20, 30, char(255), 10, 20, 30, static_cast<char>(alpha)};
  const int view = maker.view(tga);
  maker.push("images", {{"bufferView", view}, {"mimeType", "image/png"}});
  maker.push("textures", {{"source", 0}});
  maker.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  return maker;
}

TEST(GltfMaterials, AlphaIsOpacityByItsMode) {
  const Json factor = {{"baseColorFactor", {1, 1, 1, 0.4}}};
  const auto opacity = [&](const char* mode, double cutoff) {
    return material_of(with_material({{"alphaMode", mode},
                                      {"alphaCutoff", cutoff},
                                      {"pbrMetallicRoughness", factor}}))
        .opacity;
  };
  EXPECT_TRUE(opacity("OPAQUE", 0.5).is_opaque());
  EXPECT_FLOAT_EQ(opacity("BLEND", 0.5).offset, 0.4f);
  EXPECT_EQ(opacity("MASK", 0.5).offset, 0.0f);
  EXPECT_TRUE(opacity("MASK", 0.3).is_opaque());
}

TEST(GltfMaterials, AlphaMayBeATexture) {
  const Json factor = {{"baseColorFactor", {1, 1, 1, 0.5}}};
  const Loaded cut(with_alpha({{"alphaMode", "MASK"}, {"pbrMetallicRoughness", factor}}, 51));
  const Opacity& opacity = cut.scene.materials.at(0).opacity;
  EXPECT_EQ(opacity.cutoff, 0.5f);
  EXPECT_EQ(opacity.scale, 0.5f);
  const Texture& alpha = cut.scene.textures.at(opacity.texture);
  EXPECT_EQ(alpha.format, TextureFormat::alpha8);
  EXPECT_EQ(load_texel(alpha, cut.scene.texels.data(), 0, 0), Color(1.0f));
  EXPECT_NEAR(load_texel(alpha, cut.scene.texels.data(), 1, 0).x, 0.2f, 1e-6f);
  EXPECT_EQ(cut.scene.texels.size(), 8u) << "the picture is there twice";
  EXPECT_TRUE(material_of(with_alpha({{"alphaMode", "BLEND"}}, 255)).opacity.is_opaque());
}

TEST(GltfMaterials, ANormalTextureIsAMapOverTheMaterial) {
  const Loaded loaded(with_alpha({{"normalTexture", {{"index", 0}, {"scale", 0.5}}},
                                  {"emissiveFactor", {1, 0, 0}},
                                  {"alphaMode", "BLEND"}},
                                 128));
  const auto& materials = loaded.scene.materials;
  ASSERT_EQ(materials.size(), 2u);
  const MaterialDescription& map = materials.at(loaded.scene.meshes.at(0).material);
  EXPECT_EQ(map.node, MaterialNode::gltf_normal_map);
  EXPECT_EQ(map.scalar(0), 0.5f);
  EXPECT_EQ(loaded.scene.textures.at(map.parameters[0].texture).format, TextureFormat::linear8);
  EXPECT_EQ(map.emission.radiance, Color(1, 0, 0));
  EXPECT_FALSE(map.opacity.is_opaque());
  const MaterialDescription& inside = materials.at(map.children[0]);
  EXPECT_EQ(inside.node, MaterialNode::none);
  EXPECT_TRUE(is_black(inside.emission.radiance));
  EXPECT_TRUE(inside.opacity.is_opaque());
}

// "If the alpha value is greater than or equal to the alphaCutoff value, then it is rendered as
// fully opaque" (specification, section 3.9.4).
TEST(GltfMaterials, AlphaOfATextureThatEqualsTheCutoffIsSeen) {
  const Json half = {{"baseColorFactor", {1, 1, 1, 0.5}}};
  const auto passes = [&](double cutoff, float u) {
    const Loaded loaded(with_alpha(
        {{"alphaMode", "MASK"}, {"alphaCutoff", cutoff}, {"pbrMetallicRoughness", half}}, 51));
    Scene view;
    view.textures = loaded.scene.textures.data(), view.texels = loaded.scene.texels.data();
    view.opacities = &loaded.scene.materials.at(0).opacity;
    return passes_mask(view, 1, Triangle{}, u, 0.5f, [] { return 0u; });
  };
  EXPECT_FALSE(passes(0.5, 0.25f));  // of 0.5
  EXPECT_TRUE(passes(0.50001, 0.25f));
  EXPECT_TRUE(passes(0.5, 0.75f));  // of 0.1
  EXPECT_FALSE(passes(0.09, 0.75f));
}

}  // namespace
}  // namespace pt
