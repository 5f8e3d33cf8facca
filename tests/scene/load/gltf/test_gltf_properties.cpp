// The glTF loader: the default of every property of a material, its limits on both sides, and what
// is said beyond them.
#include "load/expect_near.h"
#include "load/gltf_files.h"

namespace pt {
namespace {

/// What a property is read into.
using Read = float (*)(const SceneData&);

const MaterialDescription& of_mesh(const SceneData& scene) {
  return scene.materials.at(scene.meshes.at(0).material);
}
template <auto member>
float scalar(const SceneData& scene) {
  return of_mesh(scene)[member].value.x;
}
float opacity(const SceneData& scene) { return of_mesh(scene).opacity.offset; }
float green_of_base(const SceneData& scene) { return of_mesh(scene).color(0).y; }
float green_of_emission(const SceneData& scene) { return of_mesh(scene).emission.radiance.y; }
float green_of_absorption(const SceneData& scene) {
  return scene.media.empty() ? 0.0f : scene.media[0].extinction.y;
}
/// The base's reflectance at normal incidence.
float reflectance(const SceneData& scene) {
  return normal_reflectance(of_mesh(scene)[&Principled::eta].value.x);
}

struct Property {
  const char* name;
  const char* material;  ///< JSON, with VALUE where the value is
  Read read;
  float by_default;
  /// Values as JSON and what they are read as.
  std::vector<std::pair<const char*, float>> values;
};

/// The material with the value in its place.
Loaded loaded_with(const std::string& text, const std::string& value) {
  std::string json = text;
  const std::size_t at = json.find("VALUE");
  json.replace(at, 5, value);
  return Loaded(with_material(Json::parse(json)));
}

#define PBR(member) R"({"pbrMetallicRoughness":{)" member "}}"
#define EXTENSION(name, members) \
  R"({"pbrMetallicRoughness":{"metallicFactor":0},"extensions":{")" name R"(":{)" members "}}}"
#define VOLUME(members)                                                                                                                                  \
  R"({"pbrMetallicRoughness":{"metallicFactor":0},"extensions":{"KHR_materials_transmission":{"transmissionFactor":1},"KHR_materials_volume":{)" members \
  "}}}"

const Property properties[] = {
    {"baseColorFactor",
     PBR(R"("x":0, "baseColorFactor":VALUE)"),
     green_of_base,
     1,
     {{"[1,0,1,1]", 0},
      {"[1,0.25,1,1]", 0.25f},
      {"[0,1,0,1]", 1},
      {"[1,1.5,1,1]", 1},
      {"[1,-1,1,1]", 0}}},
    {"metallicFactor",
     PBR(R"("metallicFactor":VALUE)"),
     scalar<&Principled::metallic>,
     1,
     {{"0", 0}, {"0.25", 0.25f}, {"1", 1}, {"1.5", 1}, {"-1", 0}}},
    {"roughnessFactor",
     PBR(R"("roughnessFactor":VALUE)"),
     scalar<&Principled::roughness>,
     1,
     {{"0", 0}, {"0.25", 0.25f}, {"1", 1}, {"1.5", 1}, {"-1", 0}}},
    {"emissiveFactor",
     R"({"emissiveFactor":VALUE})",
     green_of_emission,
     0,
     {{"[0,0.5,0]", 0.5f}, {"[0,3,0]", 3}, {"[0,-1,0]", 0}, {"[5,0,5]", 0}}},
    {"emissiveStrength",
     R"({"emissiveFactor":[1,0.5,1],"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":VALUE}}})",
     green_of_emission,
     0.5f,
     {{"0", 0}, {"1", 0.5f}, {"10", 5}, {"-1", 0}}},
    {"alpha, BLEND",
     R"({"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":VALUE}})",
     opacity,
     1,
     {{"[1,1,1,0]", 0}, {"[1,1,1,0.25]", 0.25f}, {"[1,1,1,1]", 1}}},
    {"alpha, OPAQUE",
     R"({"alphaMode":"OPAQUE","pbrMetallicRoughness":{"baseColorFactor":VALUE}})",
     opacity,
     1,
     {{"[1,1,1,0]", 1}, {"[1,1,1,0.25]", 1}}},
    // The default cutoff is 0.5, and what is equal to it is there (specification, section 3.9.4).
    {"alpha, MASK",
     R"({"alphaMode":"MASK","pbrMetallicRoughness":{"baseColorFactor":VALUE}})",
     opacity,
     1,
     {{"[1,1,1,0.49]", 0}, {"[1,1,1,0.5]", 1}, {"[1,1,1,0.51]", 1}}},
    {"alphaCutoff",
     R"({"alphaMode":"MASK","alphaCutoff":VALUE,"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.375]}})",
     opacity,
     0,
     {{"0", 1}, {"0.374", 1}, {"0.375", 1}, {"0.376", 0}, {"1", 0}, {"2", 0}}},
    {"ior",
     EXTENSION("KHR_materials_ior", R"("ior":VALUE)"),
     scalar<&Principled::eta>,
     1.5f,
     {{"1", 1.001f},
      {"1.0005", 1.001f},
      {"1.33", 1.33f},
      {"2.42", 2.42f},
      {"0.99", 1.5f},
      {"-2", 1.5f}}},
    {"specularFactor",
     EXTENSION("KHR_materials_specular", R"("specularFactor":VALUE)"),
     reflectance,
     0.04f,
     {{"1", 0.04f}, {"0.5", 0.02f}, {"2", 0.04f}, {"0", 2.5e-7f}, {"-1", 2.5e-7f}}},
    {"specularColorFactor",
     EXTENSION("KHR_materials_specular", R"("specularColorFactor":VALUE)"),
     reflectance,
     0.04f,
     {{"[1,1,1]", 0.04f}, {"[0.5,0.5,0.5]", 0.02f}, {"[2,2,2]", 0.08f}}},
    {"sheenColorFactor",
     EXTENSION("KHR_materials_sheen", R"("sheenColorFactor":VALUE)"),
     scalar<&Principled::sheen>,
     0,
     {{"[0,0,0]", 0}, {"[0,0.5,0]", 0.5f}, {"[0,2,0]", 1}}},
    {"clearcoatFactor",
     EXTENSION("KHR_materials_clearcoat", R"("clearcoatFactor":VALUE)"),
     scalar<&Principled::clearcoat>,
     0,
     {{"0", 0}, {"0.5", 0.5f}, {"2", 1}, {"-1", 0}}},
    {"clearcoatRoughnessFactor",
     EXTENSION("KHR_materials_clearcoat",
               R"("clearcoatFactor":1,"clearcoatRoughnessFactor":VALUE)"),
     scalar<&Principled::clearcoat_gloss>,
     1,
     {{"0", 1}, {"0.2", 0.606061f}, {"0.4", 0}, {"1", 0}, {"-1", 1}}},
    {"transmissionFactor",
     R"({"pbrMetallicRoughness":{"metallicFactor":0},"extensions":{"KHR_materials_volume":{"thicknessFactor":1},"KHR_materials_transmission":{"transmissionFactor":VALUE}}})",
     scalar<&Principled::spec_trans>,
     0,
     {{"0", 0}, {"0.25", 0.25f}, {"1", 1}, {"1.5", 1}, {"-1", 0}}},
    {"thicknessFactor, which parts walls from solids",
     VOLUME(R"("thicknessFactor":VALUE)"),
     [](const SceneData& scene) {
       return of_mesh(scene).kind == kind_of<Principled> ? 1.0f : 0.0f;
     },
     0,
     {{"0", 0}, {"1e-6", 1}, {"-1", 0}}},
    {"attenuationColor",
     VOLUME(R"("thicknessFactor":1,"attenuationDistance":2,"attenuationColor":VALUE)"),
     green_of_absorption,
     0,
     {{"[0,1,0]", 0}, {"[1,0.5,1]", 0.346574f}, {"[1,2,1]", 0}, {"[1,0,1]", 6.907755f}}},
    {"attenuationDistance",
     VOLUME(R"("thicknessFactor":1,"attenuationColor":[1,0.5,1],"attenuationDistance":VALUE)"),
     green_of_absorption,
     0,
     {{"1", 0.693147f}, {"0", 0}, {"-1", 0}, {"1e-3", 693.147f}}},
    {"diffuseFactor",
     EXTENSION("KHR_materials_pbrSpecularGlossiness", R"("diffuseFactor":VALUE)"),
     green_of_base,
     1,
     {{"[1,0.5,1,1]", 0.5f}, {"[1,2,1,1]", 1}, {"[1,-1,1,1]", 0}}}};

TEST(GltfProperties, DefaultsAndLimits) {
  for (const Property& property : properties) {
    SCOPED_TRACE(property.name);
    // A value of the wrong form is left out, which leaves the default.
    const Loaded none = loaded_with(property.material, R"("none")");
    EXPECT_NEAR(property.read(none.scene), property.by_default, 1e-6) << "the default";
    EXPECT_EQ(none.count("it is left out"), 1u) << testing::PrintToString(none.messages);
    for (const auto& [value, expected] : property.values) {
      const Loaded loaded = loaded_with(property.material, value);
      EXPECT_NEAR(property.read(loaded.scene), expected, 1e-5f * std::max(1.0f, expected)) << value;
    }
  }
}

TEST(GltfProperties, WhatIsSaidOfWrongValues) {
  const std::tuple<const char*, const char*, const char*> cases[] = {
      {R"({"emissiveFactor":VALUE})", "[0,-1,0]",
       "materials[0].emissiveFactor: expected finite numbers >= 0: nothing is emitted"},
      {R"({"alphaMode":VALUE})", R"("CUTOUT")",
       "'CUTOUT': expected OPAQUE, MASK or BLEND: OPAQUE is used"},
      {EXTENSION("KHR_materials_ior", R"("ior":VALUE)"), "0.5",
       "KHR_materials_ior.ior: 0.5: expected 0 or a number >= 1: 1.5 is used"},
      {VOLUME(R"("thicknessFactor":1,"attenuationDistance":VALUE)"), "0",
       "attenuationDistance: 0: expected > 0: nothing is absorbed"},
      {EXTENSION("KHR_materials_specular", R"("specularColorFactor":VALUE)"), "[1,0,0]",
       "KHR_materials_specular: its factor times the largest component"}};
  for (const auto& [material, value, message] : cases) {
    EXPECT_EQ(loaded_with(material, value).count(message), 1u) << message;
  }
  for (const char* value : {"0", "1", "1.5", "1000"}) {
    EXPECT_EQ(loaded_with(EXTENSION("KHR_materials_ior", R"("ior":VALUE)"), value).count("ior"),
              0u);
  }
}

TEST(GltfProperties, SamplersAndTransforms) {
  const auto texture_of = [](const Json& sampler, const Json& transform, const char* warning) {
    GltfMaker maker =
        with_material({{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", {{"index", 0}}}});
    if (!transform.is_null()) {
      maker.root["materials"][0]["emissiveTexture"]["extensions"] = {
          {"KHR_texture_transform", transform}};
    }
    std::string bmp("BM\x3a\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\1\0\0\0\1\0\0\0\1\0\x18\0", 30);
    bmp.resize(54);
    bmp += std::string("\xff\x80\x80\0", 4);
    maker.root["images"] = {{{"uri", "data:image/bmp;base64," + base64(bmp)}}};
    maker.root["textures"] = {{{"source", 0}}};
    if (!sampler.is_null()) {
      maker.root["samplers"] = Json::array({sampler});
      maker.root["textures"][0]["sampler"] = 0;
    }
    const Loaded loaded(maker);
    if (*warning) {
      EXPECT_EQ(loaded.count(warning), 1u) << testing::PrintToString(loaded.messages);
    }
    return loaded.scene.textures.at(of_mesh(loaded.scene).emission.texture);
  };
  for (const Json& sampler : {Json(), Json::object(), Json{{"wrapS", 10497}}, Json{{"wrapS", 1}}}) {
    const bool is_bad = sampler.is_object() && sampler.value("wrapS", 10497) == 1;
    const Texture t =
        texture_of(sampler, nullptr, is_bad ? "samplers[0].wrapS: 1: expected 10497" : "");
    EXPECT_EQ(t.wrap_u, TextureWrap::repeat);
    EXPECT_EQ(t.wrap_v, TextureWrap::repeat);
    EXPECT_EQ(t.filter, TextureFilter::bilinear);
  }
  EXPECT_EQ(texture_of({{"magFilter", 9729}}, nullptr, "").filter, TextureFilter::bilinear);
  EXPECT_EQ(texture_of({{"minFilter", 9728}}, nullptr, "").filter, TextureFilter::bilinear);
  EXPECT_EQ(texture_of({{"wrapT", 33071}}, nullptr, "").wrap_v, TextureWrap::clamp);
  const Texture plain = texture_of(nullptr, Json::object(), "");
  const Texture unlike =
      texture_of(nullptr, {{"offset", "x"}}, "offset: expected an array of numbers");
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(plain.u_row[i], i == 0 ? 1.0f : 0.0f);
    EXPECT_EQ(plain.v_row[i], i == 1 ? 1.0f : 0.0f);
    EXPECT_EQ(unlike.u_row[i], plain.u_row[i]);
  }
  const Texture half = texture_of(nullptr, {{"scale", {0.5, 1}}}, "");
  EXPECT_EQ(half.u_row[0], 0.5f);
  EXPECT_EQ(half.v_row[1], 1.0f);
  GltfMaker maker =
      with_material({{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", {{"index", 0}}}});
  maker.root["textures"] = {{{"source", 0}, {"sampler", 5}}};
  std::string bmp("BM\x3a\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\1\0\0\0\1\0\0\0\1\0\x18\0", 30);
  bmp.resize(54);
  maker.root["images"] = {{{"uri", "data:image/bmp;base64," + base64(bmp + std::string(4, '\1'))}}};
  EXPECT_EQ(Loaded(maker).count("textures[0].sampler: samplers[5] does not exist"), 1u);
}

// Each slot of a texture whose picture cannot be had: the factor's value alone, and one warning
// that names the picture.
TEST(GltfProperties, EverySlotLivesWithoutItsPicture) {
  struct Slot {
    const char* material;
    Read read;
    float expected;
  };
  const Slot slots[] = {
      {PBR(R"("baseColorFactor":[1,0.5,1,1],"baseColorTexture":VALUE)"), green_of_base, 0.5f},
      {PBR(R"("roughnessFactor":0.5,"metallicRoughnessTexture":VALUE)"),
       scalar<&Principled::roughness>, 0.5f},
      {R"({"normalTexture":VALUE})", scalar<&Principled::roughness>, 1},
      {R"({"emissiveFactor":[1,0.5,1],"emissiveTexture":VALUE})", green_of_emission, 0.5f},
      {R"({"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.5],"baseColorTexture":VALUE}})",
       opacity, 0.5f},
      {R"({"alphaMode":"BLEND","doubleSided":true,"pbrMetallicRoughness":{"baseColorTexture":VALUE},"extensions":{"KHR_materials_unlit":{}}})",
       green_of_emission, 1},
      {EXTENSION("KHR_materials_sheen",
                 R"("sheenColorFactor":[0,0.5,0],"sheenColorTexture":VALUE)"),
       scalar<&Principled::sheen>, 0.5f},
      {EXTENSION("KHR_materials_clearcoat", R"("clearcoatFactor":0.5,"clearcoatTexture":VALUE)"),
       scalar<&Principled::clearcoat>, 0.5f},
      {EXTENSION(
           "KHR_materials_clearcoat",
           R"("clearcoatFactor":1,"clearcoatRoughnessFactor":0.2,"clearcoatRoughnessTexture":VALUE)"),
       scalar<&Principled::clearcoat_gloss>, 0.606061f},
      {EXTENSION("KHR_materials_pbrSpecularGlossiness",
                 R"("diffuseFactor":[1,0.5,1,1],"diffuseTexture":VALUE)"),
       green_of_base, 0.5f},
      {VOLUME(
           R"("thicknessFactor":1},"KHR_materials_transmission":{"transmissionFactor":0.5,"transmissionTexture":VALUE)"),
       scalar<&Principled::spec_trans>, 0.5f}};
  const Json images[] = {{{"uri", "absent.png"}},
                         {{"uri", "data:image/png;base64,AAAA"}},
                         {{"uri", "data:image/ktx2;base64,AAAA"}},
                         {{"uri", "data:nonsense"}},
                         {{"bufferView", 0}, {"mimeType", "image/png"}},
                         {{"bufferView", 0}, {"mimeType", "video/mp4"}},
                         {{"bufferView", 99}, {"mimeType", "image/png"}},
                         Json::object()};
  for (const Slot& slot : slots) {
    for (const Json& image : images) {
      std::string json = slot.material;
      json.replace(json.find("VALUE"), 5, R"({"index":0})");
      GltfMaker maker = with_material(Json::parse(json));
      maker.root["textures"] = {{{"source", 0}}};
      maker.root["images"] = Json::array({image});
      const Loaded loaded(maker);
      EXPECT_NEAR(slot.read(loaded.scene), slot.expected, 1e-5) << json << image;
      EXPECT_GE(loaded.count("images[0]"), 1u) << json << image;
      for (const MaterialDescription& m : loaded.scene.materials)
        EXPECT_FALSE(m.is_textured()) << json;
    }
  }
}

#undef PBR
#undef EXTENSION
#undef VOLUME

}  // namespace
}  // namespace pt
