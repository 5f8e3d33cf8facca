// The glTF loader: materials, textures, lights and cameras.
#include "gltf_files.h"

namespace pt {
namespace {

/// The triangle with a material.
GltfMaker with_material(const Json& material) {
  GltfMaker maker = triangle_file();
  maker.root["materials"] = {material};
  maker.root["meshes"][0]["primitives"][0]["material"] = 0;
  return maker;
}

Material material_of(const GltfMaker& maker) {
  const Loaded loaded(maker);
  return loaded.scene.materials.at(loaded.scene.meshes.at(0).material);
}

TEST(GltfMaterials, BelowHalfMetallicIsDiffuse) {
  GltfMaker maker = with_material({{"pbrMetallicRoughness",
                                    {{"baseColorFactor", {0.1, 0.2, 0.3, 1}},
                                     {"metallicFactor", 0.4},
                                     {"roughnessFactor", 0.5}}}});
  const Material one_sided = material_of(maker);
  EXPECT_EQ(one_sided.kind, MaterialKind::diffuse);
  expect_near(one_sided.albedo, {0.1f, 0.2f, 0.3f});
  EXPECT_TRUE(one_sided.one_sided);
  EXPECT_EQ(one_sided.textures, 0u);
  maker.root["materials"][0]["doubleSided"] = true;
  EXPECT_FALSE(material_of(maker).one_sided);
}

TEST(GltfMaterials, MetalHasTheFuzzOfRoughnessSquared) {
  const Material metal = material_of(
      with_material({{"pbrMetallicRoughness",
                      {{"baseColorFactor", {0.9, 0.8, 0.7, 1}}, {"roughnessFactor", 0.5}}}}));
  EXPECT_EQ(metal.kind, MaterialKind::metal);
  expect_near(metal.albedo, {0.9f, 0.8f, 0.7f});
  EXPECT_FLOAT_EQ(metal.parameter, 0.25f);
  EXPECT_FALSE(metal.one_sided);
}

TEST(GltfMaterials, TheDefaultMaterialIsRoughWhiteMetal) {  // so says the specification
  const Material material = material_of(triangle_file());
  EXPECT_EQ(material.kind, MaterialKind::metal);
  EXPECT_EQ(material.parameter, 1.0f);
  EXPECT_EQ(material.albedo, Color(1.0f));
}

TEST(GltfMaterials, TransmissionIsGlass) {
  GltfMaker maker = with_material({{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 1, 1, 1}}}},
                                   {"extensions",
                                    {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                                     {"KHR_materials_ior", {{"ior", 1.33}}}}}});
  const Material water = material_of(maker);
  EXPECT_EQ(water.kind, MaterialKind::dielectric);
  EXPECT_FLOAT_EQ(water.parameter, 1.33f);
  expect_near(water.albedo, {0.5f, 1, 1});
  maker.root["materials"][0]["extensions"].erase("KHR_materials_ior");
  EXPECT_FLOAT_EQ(material_of(maker).parameter, 1.5f);
  maker.root["materials"][0]["extensions"]["KHR_materials_transmission"]["transmissionFactor"] =
      0.4;
  EXPECT_EQ(material_of(maker).kind, MaterialKind::metal);
}

TEST(GltfMaterials, SpecularGlossinessIsDiffuse) {
  const Material material = material_of(with_material(
      {{"extensions",
        {{"KHR_materials_pbrSpecularGlossiness", {{"diffuseFactor", {0.2, 0.4, 0.6, 1}}}}}}}));
  EXPECT_EQ(material.kind, MaterialKind::diffuse);
  expect_near(material.albedo, {0.2f, 0.4f, 0.6f});
}

TEST(GltfMaterials, UnlitEmitsItsColour) {
  const Loaded loaded(
      with_material({{"pbrMetallicRoughness", {{"baseColorFactor", {0.2, 0.4, 0.6, 1}}}},
                     {"extensions", {{"KHR_materials_unlit", Json::object()}}}}));
  const Material& material = loaded.scene.materials.at(0);
  expect_near(material.emission, {0.2f, 0.4f, 0.6f});
  EXPECT_TRUE(is_black(material.albedo));
  EXPECT_TRUE(is_black(loaded.scene.sky.zenith));
}

TEST(GltfMaterials, EmissionHasAStrength) {
  const Loaded loaded(with_material(
      {{"emissiveFactor", {1, 0.5, 0.25}},
       {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}}}}));
  expect_near(loaded.scene.materials.at(0).emission, {8, 4, 2});
  EXPECT_EQ(loaded.count("no light"), 0u);
  EXPECT_TRUE(is_black(loaded.scene.sky.zenith));
}

TEST(GltfMaterials, EachKindOfApproximationIsReportedOnce) {
  GltfMaker maker = with_material({{"alphaMode", "BLEND"}});
  maker.root["materials"].push_back({{"alphaMode", "MASK"}, {"name", "other"}});
  auto& primitives = maker.root["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  primitives[1]["material"] = 1;
  const Loaded loaded(maker);
  EXPECT_EQ(loaded.scene.materials.size(), 2u);
  EXPECT_EQ(loaded.count("alphaMode"), 1u);
  EXPECT_EQ(loaded.count("metallic >= 0.5"), 1u);
  EXPECT_EQ(loaded.count("materials[0]"), 2u);
  expect_error([&] { Loaded strict(maker, true); }, "scene.gltf: materials[0]: alphaMode");
}

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
    maker.root["samplers"] = {sampler};
    maker.root["textures"][0]["sampler"] = 0;
  }
  maker.root["images"] = {{{"uri", "data:image/bmp;base64," + base64(four_texels())}}};
  return maker;
}

Texture base_texture(const SceneData& scene) {
  const Material& material = scene.materials.at(scene.meshes.at(0).material);
  return scene.textures.at(scene.material_textures.at(material.textures).albedo);
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
  EXPECT_EQ(loaded.scene.materials.at(0).albedo, Color(1.0f));
  EXPECT_EQ(texel_at(loaded.scene, texture, 0.25f, 0.75f), (std::vector{255, 0, 0}));
  EXPECT_EQ(texel_at(loaded.scene, texture, 0.75f, 0.75f), (std::vector{0, 255, 0}));
  EXPECT_EQ(texel_at(loaded.scene, texture, 0.25f, 0.25f), (std::vector{0, 0, 255}));
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
  TempFolder folder;
  std::filesystem::create_directory(folder.file("sub"));
  write_text(folder.file("scene.gltf"), external.gltf());
  expect_error([&] { load_gltf(folder.file("scene.gltf"), {}); }, "images[0]: cannot read");
  write_text(folder.file("sub/four texels.bmp"), four_texels());
  const SceneData from_file = load_gltf(folder.file("scene.gltf"), {});
  EXPECT_EQ(texel_at(from_file, base_texture(from_file), 0.75f, 0.75f), (std::vector{0, 255, 0}));
}

TEST(GltfTextures, AnImageIsStoredOnce) {
  GltfMaker maker = with_texture();
  maker.root["materials"][0]["emissiveFactor"] = {1, 1, 1};
  maker.root["materials"][0]["emissiveTexture"] = {
      {"index", 0}, {"extensions", {{"KHR_texture_transform", {{"scale", {2, 2}}}}}}};
  const Loaded loaded(maker);
  EXPECT_EQ(loaded.scene.textures.size(), 2u);
  EXPECT_EQ(loaded.scene.texels.size(), 16u);
  const MaterialTextures& textures = loaded.scene.material_textures.at(1);
  EXPECT_EQ(loaded.scene.textures.at(textures.emission).u_row[0], 2.0f);
  EXPECT_EQ(loaded.scene.textures.at(textures.albedo).u_row[0], 1.0f);
}

TEST(GltfTextures, MetallicAndRoughnessAreMeans) {
  GltfMaker maker = with_texture();
  auto& pbr = maker.root["materials"][0]["pbrMetallicRoughness"];
  pbr["metallicFactor"] = 1;
  pbr["metallicRoughnessTexture"] = {{"index", 0}};
  const Loaded loaded(maker);  // blue and green: 1 in two of four texels
  const Material& material = loaded.scene.materials.at(0);
  EXPECT_EQ(material.kind, MaterialKind::metal);
  EXPECT_NEAR(material.parameter, 0.25f, 1e-6f);
  EXPECT_EQ(loaded.count("their means are used"), 1u);
  EXPECT_EQ(loaded.scene.texels.size(), 16u);
}

TEST(GltfTextures, OtherCoordinatesAreReported) {
  EXPECT_EQ(Loaded(with_texture({{"texCoord", 1}})).count("TEXCOORD_0"), 1u);
  EXPECT_EQ(Loaded(with_texture({{"texCoord", 0}})).count("TEXCOORD_0"), 0u);
}

/// The triangle and a node with a light, turned by -90 degrees about x: -z becomes -y.
GltfMaker with_light(const Json& light) {
  GltfMaker maker = triangle_file();
  const float h = std::sqrt(0.5f);
  maker.root["nodes"].push_back({{"translation", {1, 5, 2}},
                                 {"rotation", {-h, 0, 0, h}},
                                 {"scale", {2, 2, 2}},
                                 {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  maker.root["scenes"][0]["nodes"] = {0, 1};
  maker.root["extensions"] = {{"KHR_lights_punctual", {{"lights", {light}}}}};
  return maker;
}

TEST(GltfLights, Point) {
  const Loaded loaded(with_light({{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 20}}));
  ASSERT_EQ(loaded.scene.delta_lights.size(), 1u);
  const DeltaLight& light = loaded.scene.delta_lights[0];
  EXPECT_EQ(light.kind, DeltaLight::Kind::point);
  expect_near(light.position, {1, 5, 2});
  expect_near(light.intensity, {20, 10, 0});
  EXPECT_TRUE(is_black(loaded.scene.sky.zenith));
  EXPECT_EQ(loaded.count("no light"), 0u);
}

TEST(GltfLights, Spot) {
  const Loaded loaded(with_light({{"type", "spot"},
                                  {"intensity", 3},
                                  {"range", 10},
                                  {"spot", {{"innerConeAngle", 0.5}, {"outerConeAngle", 1.0}}}}));
  const DeltaLight& light = loaded.scene.delta_lights.at(0);
  EXPECT_EQ(light.kind, DeltaLight::Kind::spot);
  expect_near(light.position, {1, 5, 2});
  expect_near(light.direction, {0, -1, 0});
  expect_near(light.intensity, {3, 3, 3});
  EXPECT_NEAR(light.cos_inner, std::cos(0.5), 1e-6);
  EXPECT_NEAR(light.cos_outer, std::cos(1.0), 1e-6);
  EXPECT_EQ(loaded.count("ranges of lights"), 1u);
}

TEST(GltfLights, Directional) {
  const Loaded loaded(with_light({{"type", "directional"}}));
  const DeltaLight& light = loaded.scene.delta_lights.at(0);
  EXPECT_EQ(light.kind, DeltaLight::Kind::directional);
  expect_near(light.direction, {0, -1, 0});
  expect_near(light.intensity, {1, 1, 1});
}

TEST(GltfLights, AreChecked) {
  expect_error([] { Loaded(with_light({{"type", "area"}})); }, "lights[0].type: 'area'");
  expect_error([] { Loaded(with_light({{"type", "point"}, {"intensity", -1}})); }, "lights[0]");
  expect_error(
      [] {
        Loaded(with_light(
            {{"type", "spot"}, {"spot", {{"innerConeAngle", 1.0}, {"outerConeAngle", 0.5}}}}));
      },
      "lights[0].spot");
}

GltfMaker with_camera(const Json& camera) {
  GltfMaker maker = triangle_file();
  const float h = std::sqrt(0.5f);
  maker.root["nodes"].push_back(
      {{"camera", 0}, {"translation", {10, 0, 0}}, {"rotation", {0, h, 0, h}}});
  maker.root["nodes"].push_back({{"camera", 0}});
  maker.root["scenes"][0]["nodes"] = {0, 1, 2};
  maker.root["cameras"] = {camera};
  return maker;
}

TEST(GltfCameras, Perspective) {
  const Loaded loaded(
      with_camera({{"type", "perspective"},
                   {"perspective", {{"yfov", 0.5}, {"aspectRatio", 1.5}, {"znear", 0.1}}}}));
  const CameraParameters& camera = loaded.scene.camera;
  expect_near(camera.look_from, {10, 0, 0});
  expect_near(normalize(camera.look_at - camera.look_from), {-1, 0, 0});
  expect_near(camera.up, {0, 1, 0});
  EXPECT_NEAR(camera.vertical_fov_degrees, 28.64789f, 1e-4f);
  EXPECT_NEAR(camera.focus_distance, 9.5f, 1e-5f);  // the triangle's middle is x = 0.5
  ASSERT_TRUE(loaded.scene.defaults.width && loaded.scene.defaults.height);
  EXPECT_EQ(*loaded.scene.defaults.width * 2, *loaded.scene.defaults.height * 3);
  EXPECT_EQ(loaded.count("no camera"), 0u);
}

TEST(GltfCameras, OrthographicIsReplacedByOneThatSeesAsMuch) {
  const Loaded loaded(
      with_camera({{"type", "orthographic"},
                   {"orthographic", {{"xmag", 4}, {"ymag", 2}, {"znear", 0.1}, {"zfar", 100}}}}));
  const CameraParameters& camera = loaded.scene.camera;
  EXPECT_EQ(loaded.count("orthographic"), 1u);
  expect_near(camera.look_at, {0.5f, 0, 0}, 1e-4f);
  const float distance = glm::length(camera.look_at - camera.look_from);
  EXPECT_NEAR(distance * std::tan(0.5f * camera.vertical_fov_degrees * pi / 180.0f), 2.0f, 1e-4f);
  expect_near(normalize(camera.look_at - camera.look_from), {-1, 0, 0});
  EXPECT_EQ(*loaded.scene.defaults.width, 2 * *loaded.scene.defaults.height);
}

TEST(GltfCameras, WithoutOneTheSceneIsFramed) {
  const Loaded loaded(triangle_file());
  EXPECT_EQ(loaded.count("no camera"), 1u);
  EXPECT_EQ(loaded.count("no light"), 1u);
  EXPECT_EQ(loaded.scene.sky.nadir, Color(1.0f));
  EXPECT_EQ(loaded.scene.sky.zenith, Color(1.0f));
  constexpr int size = 100;
  const Camera camera = make_camera(loaded.scene.camera, size, size);
  const Vec3 forward = normalize(loaded.scene.camera.look_at - loaded.scene.camera.look_from);
  for (const Vec3& p : loaded.scene.meshes.at(0).positions) {
    // Where the ray to the vertex passes the film.
    const Vec3 d = p - camera.origin;
    const Vec3 on_plane = d * (loaded.scene.camera.focus_distance / glm::dot(d, forward));
    const Vec3 from_corner = on_plane - camera.corner;
    for (const Vec3& step : {camera.step_x, camera.step_y}) {
      const float pixel = glm::dot(from_corner, step) / glm::dot(step, step);
      EXPECT_GT(pixel, 0.0f);
      EXPECT_LT(pixel, static_cast<float>(size));
    }
  }
  expect_error(
      [] {
        Loaded(
            with_camera({{"type", "perspective"}, {"perspective", {{"yfov", 4}, {"znear", 1}}}}));
      },
      "cameras[0].perspective.yfov");
}

}  // namespace
}  // namespace pt
