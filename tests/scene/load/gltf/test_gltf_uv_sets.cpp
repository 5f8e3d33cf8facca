// The glTF loader: several sets of texture coordinates on one mesh.
#include "common/texture/sample_texture.h"
#include "load/expect_near.h"
#include "load/gltf_files.h"

namespace pt {
namespace {

const Json texture_1 = {{"index", 0}, {"texCoord", 1}};

/// Two triangles with two sets, as u and v of glTF, of four vertices.
GltfMaker with_sets(const Json& material, std::initializer_list<float> uv0,
                    std::initializer_list<float> uv1) {
  GltfMaker maker;
  const int positions = maker.floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3");
  const int indices = maker.indices<std::uint16_t>({0, 1, 2, 0, 2, 3});
  Json attributes = {{"POSITION", positions}};
  if (uv0.size()) attributes["TEXCOORD_0"] = maker.floats(uv0, "VEC2");
  if (uv1.size()) attributes["TEXCOORD_1"] = maker.floats(uv1, "VEC2");
  maker.mesh({{"attributes", attributes}, {"indices", indices}, {"material", 0}});
  maker.root["materials"] = Json::array({material});
  std::string bmp("BM\x3a\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\1\0\0\0\1\0\0\0\1\0\x18\0", 30);
  bmp.resize(54);
  bmp += std::string("\xff\x80\x80\0", 4);
  maker.root["images"] = {{{"uri", "data:image/bmp;base64," + base64(bmp)}}};
  maker.root["textures"] = {{{"source", 0}}, {{"source", 0}}};
  return maker;
}

/// Where a texture is looked up at each corner of each triangle, in glTF's coordinates: by
/// position.
using Lookups = std::map<std::pair<float, float>, std::vector<Vec2>>;

template <class TextureOf>
Lookups lookups(const SceneData& scene, TextureOf texture_of) {
  Lookups result;
  for (const Mesh& mesh : scene.meshes) {
    const Texture& texture = scene.textures.at(texture_of(scene.materials.at(mesh.material)));
    for (const TriangleIndices& t : mesh.triangles) {
      for (const std::uint32_t v : t.v) {
        const Vec2 uv = map_coordinates(texture, mesh.uvs.at(v));
        result[{mesh.positions[v].x, mesh.positions[v].y}].push_back({uv.x, 1.0f - uv.y});
      }
    }
  }
  return result;
}

const auto base = [](const MaterialDescription& m) { return m.parameters[0].texture; };
const auto emissive = [](const MaterialDescription& m) { return m.emission.texture; };

void expect_lookups(const Lookups& actual, const std::vector<Vec2>& expected) {
  const std::pair<float, float> corners[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (std::size_t i = 0; i < 4; ++i) {
    ASSERT_TRUE(actual.contains(corners[i])) << i;
    for (const Vec2& uv : actual.at(corners[i])) {
      EXPECT_NEAR(uv.x, expected[i].x, 2e-5) << "corner " << i;
      EXPECT_NEAR(uv.y, expected[i].y, 2e-5) << "corner " << i;
    }
  }
}

constexpr std::initializer_list<float> square = {0, 0, 1, 0, 1, 1, 0, 1};
const std::vector<Vec2> square_uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};

TEST(GltfUvSets, AllTexturesInTheSecond) {
  for (const Json& use :
       {texture_1,
        Json{{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"texCoord", 1}}}}}},
        // A transform that names no set leaves the textureInfo's.
        Json{{"index", 0},
             {"texCoord", 1},
             {"extensions", {{"KHR_texture_transform", {{"scale", {1, 1}}}}}}}}) {
    const Loaded loaded(with_sets({{"pbrMetallicRoughness", {{"baseColorTexture", use}}}}, square,
                                  {0.5f, 0.25f, 2, 0, 3, 1, 0.75f, 9}));
    EXPECT_EQ(loaded.scene.meshes.size(), 1u);
    EXPECT_EQ(loaded.count("TEXCOORD"), 0u);
    expect_lookups(lookups(loaded.scene, base), {{0.5f, 0.25f}, {2, 0}, {3, 1}, {0.75f, 9}});
  }
}

// The transform's set counts before the textureInfo's, and its numbers come after the set's map.
TEST(GltfUvSets, AnAffineSetMovesIntoTheTransform) {
  const Json use = {
      {"index", 0},
      {"texCoord", 0},
      {"extensions",
       {{"KHR_texture_transform", {{"texCoord", 1}, {"offset", {0.5, 0}}, {"scale", {2, 3}}}}}}};
  // The second is the first turned by 90 degrees and moved.
  const Loaded loaded(with_sets({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                                 {"emissiveFactor", {1, 1, 1}},
                                 {"emissiveTexture", use}},
                                square, {0.25f, 1, 0.25f, 0, 1.25f, 0, 1.25f, 1}));
  ASSERT_EQ(loaded.scene.meshes.size(), 1u);
  EXPECT_EQ(loaded.scene.meshes[0].triangles.size(), 2u);
  EXPECT_EQ(loaded.scene.meshes[0].positions.size(), 4u);
  expect_lookups(lookups(loaded.scene, base), square_uvs);
  expect_lookups(lookups(loaded.scene, emissive), {{1, 3}, {1, 0}, {3, 0}, {3, 3}});
}

// Charts of a lightmap: each triangle has a map of its own.
TEST(GltfUvSets, ChartsBecomeParts) {
  const Loaded loaded(with_sets({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                                 {"emissiveFactor", {1, 1, 1}},
                                 {"emissiveTexture", texture_1}},
                                square, {0, 0, 1, 0, 1, 1, 0.25f, 0.5f}));
  EXPECT_EQ(loaded.scene.meshes.size(), 2u);
  EXPECT_EQ(loaded.count("TEXCOORD"), 0u);
  for (const Mesh& mesh : loaded.scene.meshes) EXPECT_EQ(mesh.positions.size(), 3u);
  expect_lookups(lookups(loaded.scene, base), square_uvs);
  expect_lookups(lookups(loaded.scene, emissive), {{0, 0}, {1, 0}, {1, 1}, {0.25f, 0.5f}});
}

// One set is a point on the second triangle, the other is not.
TEST(GltfUvSets, ATriangleWithoutExtentInOneSet) {
  for (const bool swapped : {false, true}) {
    const std::initializer_list<float> flat = {0, 0, 1, 0, 1, 1, 0.5f, 0.5f};
    const std::vector<Vec2> flat_uvs = {{0, 0}, {1, 0}, {1, 1}, {0.5f, 0.5f}};
    const Loaded loaded(with_sets({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                                   {"emissiveFactor", {1, 1, 1}},
                                   {"emissiveTexture", texture_1}},
                                  swapped ? square : flat, swapped ? flat : square));
    expect_lookups(lookups(loaded.scene, base), swapped ? square_uvs : flat_uvs);
    expect_lookups(lookups(loaded.scene, emissive), swapped ? flat_uvs : square_uvs);
  }
}

TEST(GltfUvSets, TexturesWithinExtensions) {
  const Loaded loaded(with_sets(
      {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorTexture", {{"index", 0}}}}},
       {"extensions",
        {{"KHR_materials_transmission",
          {{"transmissionFactor", 1}, {"transmissionTexture", texture_1}}}}}},
      square, {0, 0, 0.5f, 0, 0.5f, 0.5f, 0, 0.5f}));
  const auto weight = [](const MaterialDescription& m) { return m.parameters[0].texture; };
  expect_lookups(lookups(loaded.scene, weight), {{0, 0}, {0.5f, 0}, {0.5f, 0.5f}, {0, 0.5f}});
  const Json coat = {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"texCoord", 1}}}}}};
  const Loaded coated(with_sets(
      {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
       {"extensions",
        {{"KHR_materials_clearcoat", {{"clearcoatFactor", 1}, {"clearcoatTexture", coat}}}}}},
      square, {0, 0, 0.5f, 0, 0.5f, 0.5f, 0, 0.5f}));
  const auto clearcoat = [](const MaterialDescription& m) {
    return m[&Principled::clearcoat].texture;
  };
  expect_lookups(lookups(coated.scene, clearcoat), {{0, 0}, {0.5f, 0}, {0.5f, 0.5f}, {0, 0.5f}});
}

// Tangents are those of the normal map's coordinates.
TEST(GltfUvSets, TheNormalMapsSetIsTheMeshs) {
  const Loaded loaded(with_sets({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                                 {"emissiveTexture", {{"index", 0}}},
                                 {"normalTexture", texture_1}},
                                square, {0, 0, 0, 1, 1, 1, 1, 0}));
  ASSERT_EQ(loaded.scene.meshes.size(), 1u);
  EXPECT_EQ(loaded.scene.meshes[0].uvs[1], Vec2(0, 0));  // (0, 1) of glTF
  const MaterialDescription& map = loaded.scene.materials.at(loaded.scene.meshes[0].material);
  ASSERT_EQ(map.node, MaterialNode::gltf_normal_map);
  const Json turned = {{"index", 0},
                       {"extensions", {{"KHR_texture_transform", {{"texCoord", 1}}}}}};
  const Loaded by_transform(
      with_sets({{"normalTexture", turned}}, square, {0, 0, 0, 1, 1, 1, 1, 0}));
  EXPECT_EQ(by_transform.scene.meshes.at(0).uvs[1], Vec2(0, 0));
}

// Charts without number: the base colour's set for all of them, which is said.
TEST(GltfUvSets, ThousandsOfChartsAreTooMany) {
  const auto load = [](int triangles) {
    GltfMaker maker = with_sets({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}},
                                 {"emissiveFactor", {1, 1, 1}},
                                 {"emissiveTexture", texture_1}},
                                square, square);
    std::string positions, first, second;
    for (int i = 0; i < triangles; ++i) {
      const auto n = static_cast<float>(i);
      positions += bytes_of({n, 0.0f, 0.0f, n + 1, 0.0f, 0.0f, n, 1.0f, 0.0f});
      first += bytes_of({0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 1.0f});
      second += bytes_of({n, 0.0f, n + 2, 0.0f, n, 2.0f});
    }
    const auto count = static_cast<std::size_t>(3 * triangles);
    Json& primitive = maker.root["meshes"][0]["primitives"][0];
    primitive.erase("indices");
    primitive["attributes"] = {
        {"POSITION", maker.accessor(maker.view(positions), 5126, count, "VEC3")},
        {"TEXCOORD_0", maker.accessor(maker.view(first), 5126, count, "VEC2")},
        {"TEXCOORD_1", maker.accessor(maker.view(second), 5126, count, "VEC2")}};
    return Loaded(maker);
  };
  const Loaded most = load(4096), more = load(4097);
  EXPECT_EQ(most.scene.meshes.size(), 4096u);
  EXPECT_EQ(most.count("in more than 4096 pieces"), 0u);
  EXPECT_EQ(more.scene.meshes.size(), 1u);
  EXPECT_EQ(more.count("in more than 4096 pieces: TEXCOORD_0 is used for all"), 1u);
}

TEST(GltfUvSets, AMissingSetIsReported) {
  const Json material = {{"pbrMetallicRoughness", {{"baseColorTexture", texture_1}}}};
  const Loaded loaded(with_sets(material, square, {}));
  EXPECT_EQ(loaded.count("TEXCOORD_1 is missing, which a texture of its material uses: another"),
            1u);
  expect_lookups(lookups(loaded.scene, base), square_uvs);
  EXPECT_EQ(Loaded(with_sets(material, {}, {})).count("TEXCOORD_1 is missing"), 1u);
  EXPECT_EQ(Loaded(with_sets(Json::object(), square, {})).count("TEXCOORD"), 0u);
}

}  // namespace
}  // namespace pt
