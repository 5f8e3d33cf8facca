// The glTF loader: textures.
#include <fmt/format.h>

#include "common/texture/sample_texture.h"
#include "load/gltf_files.h"
#include "load/png_bytes.h"

namespace pt {
namespace {

/// A BMP of two by two texels, B G R: red, green above blue, white.
const std::string& four_texels() {
  static const std::string bytes = [] {
    const auto u16 = [](int x) { return bytes_of({static_cast<std::uint16_t>(x)}); };
    const auto u32 = [](int x) { return bytes_of({static_cast<std::uint32_t>(x)}); };
    const auto row = [](std::initializer_list<std::uint8_t> row_bytes) {
      return bytes_of(row_bytes) + std::string(2, '\0');
    };
    return "BM" + u32(70) + u32(0) + u32(54) + u32(40) + u32(2) + u32(2) + u16(1) + u16(24) +
           u32(0) + u32(16) + u32(2835) + u32(2835) + u32(0) + u32(0) +
           row({255, 0, 0, 255, 255, 255}) +  // the lower row comes first
           row({0, 0, 255, 0, 255, 0});
  }();
  return bytes;
}

/// A material with the texels as base colour; `use` is merged into the textureInfo.
GltfMaker with_texture(const Json& use = Json::object(), const Json& sampler = Json()) {
  GltfMaker maker = with_material(
      {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorTexture", {{"index", 0}}}}}});
  maker.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"].update(use);
  maker.root["textures"] = {{{"source", 0}}};
  if (!sampler.is_null()) {
    maker.root["samplers"] = Json::array({sampler});
    maker.root["textures"][0]["sampler"] = 0;
  }
  maker.root["images"] = {{{"uri", "data:image/bmp;base64," + base64(four_texels())}}};
  return maker;
}

Texture base_texture(const SceneData& scene) {
  const MaterialDescription& material = scene.materials.at(scene.meshes.at(0).material);
  return scene.textures.at(material.parameters[0].texture);
}

/// The texel of a texture at (u, v), the nearest, as R G B.
std::vector<int> texel_at(const SceneData& scene, const Texture& t, float u, float v) {
  const float tu = t.u_row[0] * u + t.u_row[1] * v + t.u_row[2];
  const float tv = t.v_row[0] * u + t.v_row[1] * v + t.v_row[2];
  const auto x = static_cast<std::size_t>((tu - std::floor(tu)) * 2.0f);
  const auto y = static_cast<std::size_t>((1.0f - (tv - std::floor(tv))) * 2.0f);
  const std::byte* texel = scene.texels.data() + t.offset + 4 * (2 * y + x);
  return {static_cast<int>(texel[0]), static_cast<int>(texel[1]), static_cast<int>(texel[2])};
}

TEST(GltfTextures, BaseColourIsSrgbAndHeadUp) {
  const Loaded loaded(with_texture());
  const Texture texture = base_texture(loaded.scene);
  EXPECT_EQ(texture.kind, TextureKind::image);
  EXPECT_EQ(texture.format, TextureFormat::srgb8);
  EXPECT_EQ(texture.width, 2u);
  EXPECT_EQ(texture.height, 2u);
  EXPECT_EQ(texture.wrap_u, TextureWrap::repeat);
  EXPECT_EQ(texture.filter, TextureFilter::bilinear);
  EXPECT_EQ(loaded.scene.materials.at(0).color(0), Color(1.0f));
  EXPECT_EQ(texel_at(loaded.scene, texture, 0.25f, 0.75f), (std::vector{255, 0, 0}));
  EXPECT_EQ(texel_at(loaded.scene, texture, 0.75f, 0.75f), (std::vector{0, 255, 0}));
  EXPECT_EQ(texel_at(loaded.scene, texture, 0.25f, 0.25f), (std::vector{0, 0, 255}));
}

TEST(GltfTextures, FactorsMultiplyTheirTextures) {
  GltfMaker maker = with_texture();
  Json& material = maker.root["materials"][0];
  material["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 0.25, 0.125, 1};
  material["emissiveFactor"] = {0.75, 0.5, 0.25};
  material["emissiveTexture"] = {{"index", 0}};
  const Loaded loaded(maker);
  EXPECT_EQ(loaded.scene.materials.at(0).color(0), Color(0.5f, 0.25f, 0.125f));
  EXPECT_EQ(loaded.scene.materials.at(0).emission.radiance, Color(0.75f, 0.5f, 0.25f));
  const MaterialDescription& textured = loaded.scene.materials.at(0);
  EXPECT_NE(textured.parameters[0].texture, no_texture);
  EXPECT_NE(textured.emission.texture, no_texture);
  // The texture itself is not coloured: the factor would count twice.
  EXPECT_EQ(loaded.scene.textures.at(textured.parameters[0].texture).color0, Color(1.0f));
  EXPECT_EQ(loaded.scene.textures.at(textured.emission.texture).color0, Color(1.0f));
}

TEST(GltfTextures, UnlitOnesShine) {
  GltfMaker maker = with_texture();
  maker.root["materials"][0]["extensions"] = {{"KHR_materials_unlit", Json::object()}};
  const Loaded loaded(maker);
  const MaterialDescription& material = loaded.scene.materials.at(0);
  EXPECT_NE(material.emission.texture, no_texture);
  EXPECT_EQ(material.parameters[0].texture, no_texture);
}

TEST(GltfTextures, SamplersSayWrapAndFilter) {
  const Loaded loaded(
      with_texture(Json::object(), {{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}));
  const Texture texture = base_texture(loaded.scene);
  EXPECT_EQ(texture.wrap_u, TextureWrap::clamp);
  EXPECT_EQ(texture.wrap_v, TextureWrap::mirror);
  EXPECT_EQ(texture.filter, TextureFilter::nearest);
}

TEST(GltfTextures, TransformsAsTheExtensionsExampleSays) {
  // KHR_texture_transform's example: 'only the lower left quadrant of the source image, rotated
  // clockwise 90 degrees'. Here that is the blue texel.
  const Loaded quadrant(with_texture(
      {{"extensions",
        {{"KHR_texture_transform",
          {{"offset", {0, 1}}, {"rotation", 1.57079632679}, {"scale", {0.5, 0.5}}}}}}}));
  const Texture texture = base_texture(quadrant.scene);
  for (const float u : {0.05f, 0.95f}) {
    for (const float v : {0.05f, 0.95f}) {
      EXPECT_EQ(texel_at(quadrant.scene, texture, u, v), (std::vector{0, 0, 255})) << u << " " << v;
    }
  }
  // 'inverts the T axis'
  const Loaded inverted(with_texture(
      {{"extensions", {{"KHR_texture_transform", {{"offset", {0, 1}}, {"scale", {1, -1}}}}}}}));
  EXPECT_EQ(texel_at(inverted.scene, base_texture(inverted.scene), 0.25f, 0.25f),
            (std::vector{255, 0, 0}));
  // A quarter to the right and nothing up or down.
  const Loaded moved(
      with_texture({{"extensions", {{"KHR_texture_transform", {{"offset", {0.5, 0}}}}}}}));
  EXPECT_EQ(texel_at(moved.scene, base_texture(moved.scene), 0.25f, 0.75f),
            (std::vector{0, 255, 0}));
}

TEST(GltfTextures, ImagesInBufferViewsAndFiles) {
  GltfMaker embedded = with_texture();
  const int view = embedded.view(four_texels());
  embedded.root["images"][0] = {{"bufferView", view}, {"mimeType", "image/bmp"}};
  const Loaded from_view(embedded.glb(), false, "scene.glb");
  EXPECT_EQ(texel_at(from_view.scene, base_texture(from_view.scene), 0.25f, 0.75f),
            (std::vector{255, 0, 0}));
  GltfMaker external = with_texture();
  external.root["images"][0] = {{"uri", "sub/four%20texels.bmp"}};
  external.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] =
      external.floats({0, 0, 1, 0, 0, 1}, "VEC2");
  TempFolder folder;
  std::filesystem::create_directory(folder.file("sub"));
  write_text(folder.file("scene.gltf"), external.gltf());
  LoadOptions strict;
  strict.strict = true;
  expect_error([&] { load_gltf(folder.file("scene.gltf"), strict); }, "images[0]: cannot read");
  write_text(folder.file("sub/four texels.bmp"), four_texels());
  const SceneData from_file = load_gltf(folder.file("scene.gltf"), {});
  EXPECT_EQ(texel_at(from_file, base_texture(from_file), 0.75f, 0.75f), (std::vector{0, 255, 0}));
}

// The content says what a picture is, and not the type that its URI names.
TEST(GltfTextures, TypesOfDataUrisDoNotMatter) {
  GltfMaker maker = with_texture();
  for (const char* type : {"image/bmp", "image/jpg", "image/x-ms-bmp", "application/octet-stream",
                           "", "image/png;charset=utf-8"}) {
    maker.root["images"][0]["uri"] = fmt::format("data:{};base64,{}", type, base64(four_texels()));
    const Loaded loaded(maker);
    EXPECT_EQ(loaded.count("images"), 0u) << type;
    EXPECT_EQ(texel_at(loaded.scene, base_texture(loaded.scene), 0.25f, 0.75f),
              (std::vector{255, 0, 0}))
        << type;
  }
}

TEST(GltfTextures, AnImageIsStoredOnce) {
  GltfMaker maker = with_texture();
  maker.root["materials"][0]["emissiveFactor"] = {1, 1, 1};
  maker.root["materials"][0]["emissiveTexture"] = {
      {"index", 0}, {"extensions", {{"KHR_texture_transform", {{"scale", {2, 2}}}}}}};
  const Loaded loaded(maker);
  EXPECT_EQ(loaded.scene.textures.size(), 2u);
  EXPECT_EQ(loaded.scene.texels.size(), 16u);
  const MaterialDescription& textured = loaded.scene.materials.at(0);
  EXPECT_EQ(loaded.scene.textures.at(textured.emission.texture).u_row[0], 2.0f);
  EXPECT_EQ(loaded.scene.textures.at(textured.parameters[0].texture).u_row[0], 1.0f);
}

TEST(GltfTextures, MetallicIsBlueAndRoughnessGreen) {
  GltfMaker maker = with_texture();
  auto& pbr = maker.root["materials"][0]["pbrMetallicRoughness"];
  pbr["metallicFactor"] = 1, pbr["roughnessFactor"] = 0.5;
  pbr["metallicRoughnessTexture"] = {{"index", 0}};
  // A white texel without its red and green.
  std::string texels = four_texels();
  texels[54 + 4] = texels[54 + 5] = '\0';
  maker.root["images"][0]["uri"] = "data:image/bmp;base64," + base64(texels);
  const Loaded loaded(maker);
  const MaterialDescription& material = loaded.scene.materials.at(0);
  EXPECT_EQ(material.kind, kind_of<Principled>);
  EXPECT_EQ(material.scalar(1), 0.5f);
  EXPECT_EQ(loaded.count("metallic"), 0u);
  const auto mean = [&](int parameter) {
    double sum = 0;
    for (const Vec2 uv :
         {Vec2(0.25f, 0.25f), Vec2(0.75f, 0.25f), Vec2(0.25f, 0.75f), Vec2(0.75f, 0.75f)}) {
      const Texture& texture = loaded.scene.textures.at(material.parameters[parameter].texture);
      const Color color = sample_texture(texture, loaded.scene.texels.data(), uv);
      EXPECT_EQ(color, Color(color.x));
      sum += color.x;
    }
    return sum / 4;
  };
  EXPECT_EQ(mean(1), 0.25);  // green in one of four texels, blue in two
  EXPECT_EQ(mean(2), 0.5);
}

TEST(GltfTextures, NumbersThatCannotBeReadLeaveTheFactor) {
  GltfMaker maker = with_texture();
  auto& pbr = maker.root["materials"][0]["pbrMetallicRoughness"];
  pbr["metallicFactor"] = 1, pbr["roughnessFactor"] = 0.8;
  pbr["metallicRoughnessTexture"] = {{"index", 1}};
  maker.root["textures"].push_back({{"source", 1}});
  for (const char* uri : {"data:image/png;base64,AAAA", "missing.ktx2"}) {
    maker.root["images"][1] = {{"uri", uri}};
    const Loaded loaded(maker);
    EXPECT_EQ(loaded.scene.materials.at(0).scalar(1), 0.8f);
    EXPECT_EQ(loaded.scene.materials.at(0).parameters[1].texture, no_texture);
    EXPECT_EQ(loaded.count("images[1]"), 1u);
    EXPECT_EQ(loaded.count("the factor alone is used"), 1u);
    expect_error([&] { Loaded strict(maker, true); }, "--strict");
  }
  maker.root["textures"][1] = {{"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}};
  EXPECT_EQ(Loaded(maker).count("textures[1].source"), 1u);
}

// A base colour, what is emitted, alpha and a normal map, of one image that we lack: KTX2 by its
// extension and by its name, and no image at all.
TEST(GltfTextures, ColorsThatCannotBeReadLeaveTheFactor) {
  GltfMaker maker = with_texture();
  maker.root["materials"][0] = {
      {"pbrMetallicRoughness",
       {{"baseColorFactor", {0.5, 0.25, 0.125, 0.75}}, {"baseColorTexture", {{"index", 0}}}}},
      {"alphaMode", "BLEND"},
      {"emissiveFactor", {1, 0.5, 0.25}},
      {"emissiveTexture", {{"index", 0}}},
      {"normalTexture", {{"index", 0}}}};
  maker.root["extensionsUsed"] = maker.root["extensionsRequired"] = {"KHR_texture_basisu"};
  const Json textures[] = {{{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}},
                           {{"source", 0}}};
  const Json images[] = {{{"uri", "picture.ktx2"}, {"mimeType", "image/ktx2"}},
                         {{"uri", "data:image/png;base64,AAAA"}}};
  for (const Json& texture : textures) {
    for (const Json& image : images) {
      maker.root["textures"][0] = texture, maker.root["images"][0] = image;
      const Loaded loaded(maker);
      const MaterialDescription& m = loaded.scene.materials.at(loaded.scene.meshes.at(0).material);
      EXPECT_EQ(m.node, MaterialNode::none) << "no map";
      EXPECT_EQ(m.color(0), Color(0.5f, 0.25f, 0.125f));
      EXPECT_EQ(m.emission.radiance, Color(1, 0.5f, 0.25f));
      EXPECT_EQ(m.opacity.offset, 0.75f);
      EXPECT_TRUE(m.opacity.is_constant());
      EXPECT_FALSE(m.is_textured());
      EXPECT_EQ(loaded.count("the factor alone is used"), 1u);
      EXPECT_EQ(loaded.count("there is no map"), 1u);
      expect_error([&] { Loaded strict(maker, true); }, "--strict");
    }
  }
  maker.root["textures"][0] = {{"source", 7}};
  EXPECT_EQ(Loaded(maker).count("textures[0].source"), 2u);
}

// Beside an extension's image, one that we can read.
TEST(GltfTextures, TheFallbackOfAnExtensionIsUsed) {
  GltfMaker maker = with_texture();
  maker.root["textures"][0]["extensions"] = {{"KHR_texture_basisu", {{"source", 1}}}};
  maker.root["images"].push_back({{"uri", "picture.ktx2"}});
  maker.root["extensionsUsed"] = {"KHR_texture_basisu"};
  const Loaded loaded(maker);
  EXPECT_EQ(texel_at(loaded.scene, base_texture(loaded.scene), 0.25f, 0.75f),
            (std::vector{255, 0, 0}));
  EXPECT_EQ(loaded.count("the factor alone is used"), 0u);
}

// By the extension's matrices: translation * rotation * scale, of (u, v) with v downwards.
TEST(GltfTextures, RotationsComeAfterScales) {
  const double angle = 0.7, c = std::cos(angle), s = std::sin(angle);
  const Loaded loaded(
      with_texture({{"extensions",
                     {{"KHR_texture_transform",
                       {{"offset", {0.1, 0.2}}, {"rotation", angle}, {"scale", {2, 0.5}}}}}}}));
  const double u = 0.3, v = 0.4, x = 2 * u, y = 0.5 * v;
  const Vec2 mapped = map_coordinates(base_texture(loaded.scene), Vec2(u, 1 - v));
  EXPECT_NEAR(mapped.x, c * x + s * y + 0.1, 1e-6);
  EXPECT_NEAR(1 - mapped.y, -s * x + c * y + 0.2, 1e-6);
}

/// The value of a parameter's texture in the middles of the texels, row by row from the head.
std::vector<float> values_of(const SceneData& scene, const Parameter& parameter) {
  std::vector<float> values;
  for (const Vec2 uv :
       {Vec2(0.25f, 0.75f), Vec2(0.75f, 0.75f), Vec2(0.25f, 0.25f), Vec2(0.75f, 0.25f)}) {
    const Texture& texture = scene.textures.at(parameter.texture);
    values.push_back(sample_texture(texture, scene.texels.data(), uv).x);
  }
  return values;
}

// Red, green, blue, white: a coat is as strong as its texture is red (KHR_materials_clearcoat). The
// sheen's three colours are one number, their mean.
TEST(GltfTextures, CoatsAreRedAndSheenIsTheMean) {
  GltfMaker maker = with_texture();
  maker.root["materials"][0]["extensions"] = {
      {"KHR_materials_clearcoat", {{"clearcoatFactor", 1}, {"clearcoatTexture", {{"index", 0}}}}},
      {"KHR_materials_sheen",
       {{"sheenColorFactor", {1, 1, 1}}, {"sheenColorTexture", {{"index", 0}}}}}};
  const SceneData scene = Loaded(maker).scene;
  const MaterialDescription& material = scene.materials.at(0);
  EXPECT_EQ(values_of(scene, material[&Principled::clearcoat]), (std::vector<float>{1, 0, 0, 1}));
  const std::vector<float> sheen = values_of(scene, material[&Principled::sheen]);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(sheen[i], i == 3 ? 1.0f : 1.0f / 3.0f, 1e-6f) << i;
}

// A roughness whose texture has the mean 1/2 (its green), in 8 and in 16 bits.
TEST(GltfTextures, TheMeanOfACoatsRoughness) {
  for (const int bits : {8, 16}) {
    GltfMaker maker = with_texture();
    const std::string half = bits == 8 ? "\x80" : std::string("\x80\0", 2), none(bits / 8, '\0');
    const std::string png = png_file(1, 1, bits, 2, none + half + none);
    maker.root["images"][0]["uri"] = "data:image/png;base64," + base64(png);
    maker.root["materials"][0]["extensions"] = {{"KHR_materials_clearcoat",
                                                 {{"clearcoatFactor", 1},
                                                  {"clearcoatRoughnessFactor", 0.4},
                                                  {"clearcoatRoughnessTexture", {{"index", 0}}}}}};
    // The gloss of alpha = 0.2^2.
    EXPECT_NEAR(Loaded(maker).scene.materials.at(0)[&Principled::clearcoat_gloss].value.x,
                (0.1 - 0.04) / 0.099, 4e-3)
        << bits;
  }
}

// The texels' red is 1, 0, 0, 1; their green 0, 1, 0, 1; their blue 0, 0, 1, 1.
TEST(GltfTextures, TransmissionIsRed) {
  GltfMaker maker = with_texture();
  std::string texels = four_texels();
  texels[54 + 5] = '\0';  // the white texel's red
  maker.root["images"][0]["uri"] = "data:image/bmp;base64," + base64(texels);
  maker.root["materials"][0]["extensions"] = {
      {"KHR_materials_transmission",
       {{"transmissionFactor", 1}, {"transmissionTexture", {{"index", 0}}}}}};
  const Loaded loaded(maker);
  const MaterialDescription& blend = loaded.scene.materials.at(loaded.scene.meshes.at(0).material);
  ASSERT_EQ(blend.node, MaterialNode::blend);
  const Parameter& p = blend.parameters[0];
  double sum = 0;
  for (const Vec2 uv :
       {Vec2(0.25f, 0.25f), Vec2(0.75f, 0.25f), Vec2(0.25f, 0.75f), Vec2(0.75f, 0.75f)}) {
    sum += sample_texture(loaded.scene.textures.at(p.texture), loaded.scene.texels.data(), uv).x;
  }
  EXPECT_EQ(sum, 1.0);  // green and blue are 2
}

}  // namespace
}  // namespace pt
