// The glTF loader: files that are malformed get one line, never a crash.
#include <sys/stat.h>

#include "load/gltf_files.h"

namespace pt {
namespace {

void expect_load_error(const std::string& content, const std::string& part) {
  expect_error([&] { Loaded loaded(content); }, part);
  expect_error([&] { Loaded loaded(content); }, "scene.gltf");
}

/// Sets a value of the triangle's file, or of one with indices.
void expect_error_with(const std::string& pointer, const Json& value, const std::string& part) {
  GltfMaker maker = triangle_file();
  maker.root["meshes"][0]["primitives"][0]["indices"] =
      maker.indices(std::initializer_list<std::uint16_t>{0, 1, 2});
  maker.root[Json::json_pointer(pointer)] = value;
  SCOPED_TRACE(pointer + " = " + value.dump());
  expect_load_error(maker.gltf(), part);
}

/// The same with a value that is lost: one warning, and a scene.
void expect_warning_with(const std::string& pointer, const Json& value, const std::string& part) {
  GltfMaker maker = triangle_file();
  maker.root["nodes"].push_back({{"mesh", 0}});
  maker.root["scenes"][0]["nodes"] = {0, 1};
  maker.root["materials"] = {Json::object()};
  maker.root["meshes"][0]["primitives"][0]["material"] = 0;
  maker.root[Json::json_pointer(pointer)] = value;
  SCOPED_TRACE(pointer + " = " + value.dump());
  const Loaded loaded(maker);
  EXPECT_EQ(loaded.count(part), 1u) << testing::PrintToString(loaded.messages);
  EXPECT_FALSE(loaded.scene.meshes.empty());
  expect_error([&] { Loaded strict(maker, true); }, "--strict");
}

constexpr const char* position = "meshes[0].primitives[0].attributes.POSITION";

TEST(GltfErrors, Files) {
  expect_error([] { load_gltf("/nowhere/scene.gltf", {}); }, "/nowhere/scene.gltf: cannot be read");
  expect_error([] { load_gltf("/", {}); }, "cannot be read");
  expect_load_error("", "parse error");
  expect_load_error("[]", "expected a JSON object");
  expect_load_error("{\"asset\": {\"version\": \"2.0\"}", "line 1");
  expect_load_error("{\"scene\": 0}", "asset");
  expect_load_error("{\"asset\": {\"version\": \"1.0\"}}", "asset.version: 1.0");
  expect_load_error("{\"asset\": {\"version\": \"2.0\"}}", "no triangles");
}

TEST(GltfErrors, NestingIsLimited) {
  const std::string deep(200000, '[');
  const std::string close(200000, ']');
  expect_load_error("{\"asset\": {\"version\": \"2.0\"}, \"extras\": " + deep + close + "}",
                    "nested too deeply");
}

TEST(GltfErrors, AccessorsStayWithinTheirBuffers) {
  expect_error_with("/accessors/0/count", 4, position);
  expect_error_with("/accessors/0/count", 2147483647, position);
  expect_error_with("/accessors/0/count", 18446744073709551615u, "accessors[0].count");
  expect_error_with("/accessors/0/count", -3, "accessors[0].count");
  expect_error_with("/accessors/0/count", 1e30, "accessors[0].count");
  expect_error_with("/accessors/0/byteOffset", -4, "accessors[0].byteOffset");
  expect_error_with("/accessors/0/byteOffset", 4, position);
  expect_error_with("/accessors/0/byteOffset", 2147483647, position);
  expect_error_with("/accessors/0/bufferView", 9, position);
  expect_error_with("/accessors/0/type", "VEC2", position);
  expect_error_with("/accessors/0/type", "VEC9", "VEC9");
  expect_error_with("/accessors/0/componentType", 5124, position);
  expect_error_with("/bufferViews/0/byteStride", 8, position);
  expect_error_with("/bufferViews/0/byteStride", 16, position);
  expect_error_with("/bufferViews/0/byteOffset", 60, "bufferViews[0]");
  expect_error_with("/bufferViews/0/byteLength", 2147483647, "bufferViews[0]");
  expect_error_with("/bufferViews/0/byteLength", 0, "bufferViews[0]");
  expect_error_with("/bufferViews/0/buffer", 1, "bufferViews[0]: buffers[1] does not exist");
}

TEST(GltfErrors, ZerosWithoutABufferAreLimited) {
  GltfMaker maker = triangle_file();
  maker.root["accessors"][0].erase("bufferView");
  maker.root["accessors"][0]["count"] = 2147483646;
  expect_load_error(maker.gltf(), position);
}

TEST(GltfErrors, SparseAccessorsAreChecked) {
  GltfMaker maker = triangle_file();
  const int indices = maker.view(bytes_of<std::uint16_t>({0, 3}));
  const int values = maker.view(bytes_of<float>({5, 6, 7, 8, 9, 10}));
  Json& sparse = maker.root["accessors"][0]["sparse"];
  sparse = {{"count", 2},
            {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
            {"values", {{"bufferView", values}}}};
  expect_load_error(maker.gltf(), "sparse.indices: entry 1 is 3");
  sparse["count"] = 3;
  expect_load_error(maker.gltf(), "sparse.indices");
  sparse["count"] = 2;
  sparse["values"]["byteOffset"] = 4;
  expect_load_error(maker.gltf(), "sparse.values");
  sparse["values"]["bufferView"] = 77;
  expect_load_error(maker.gltf(), "sparse.values");
  sparse["indices"]["componentType"] = 5126;
  expect_load_error(maker.gltf(), "sparse.indices: componentType 5126");
}

TEST(GltfErrors, MeshesAreChecked) {
  expect_error_with("/meshes/0/primitives/0/attributes/POSITION", 9, position);
  expect_error_with("/meshes/0/primitives/0/attributes/POSITION", -1, "attributes: expected");
  expect_error_with("/meshes/0/primitives/0/attributes/POSITION", "x", "attributes");
  expect_error_with("/meshes/0/primitives/0/attributes/NORMAL", 1, "attributes.NORMAL");
  expect_error_with("/meshes/0/primitives/0/indices", 0, "meshes[0].primitives[0].indices");
  expect_error_with("/meshes/0/primitives/0/mode", 7, "meshes[0].primitives[0].mode");
  expect_error_with("/meshes/0/primitives", 3, "meshes[0].primitives: expected an array");
  expect_error_with("/accessors/1/count", 2, "meshes[0].primitives[0]");
  GltfMaker maker = triangle_file();
  maker.root["meshes"][0]["primitives"][0]["indices"] =
      maker.indices(std::initializer_list<std::uint8_t>{0, 1, 255});
  expect_load_error(maker.gltf(), "meshes[0].primitives[0].indices: index 255");
  GltfMaker infinite;
  infinite.mesh({{"attributes",
                  {{"POSITION", infinite.floats({0, 0, 0, 1, HUGE_VALF, 0, 0, 1, 0}, "VEC3")}}}});
  expect_load_error(infinite.gltf(), "vertex 1 is not finite");
}

TEST(GltfErrors, NodesFormTrees) {
  expect_warning_with("/nodes/0/children", {0}, "nodes[0]: a cycle or two parents");
  expect_warning_with("/nodes/0/children", {5}, "nodes[0].children: nodes[5] does not exist");
  expect_warning_with("/nodes/0/mesh", 5, "nodes[0].mesh: meshes[5] does not exist");
  expect_warning_with("/scenes/0/nodes", {0, 0, 1}, "nodes[0]: a cycle or two parents");
  expect_warning_with("/scene", 2, "scene: scenes[2] does not exist, there are 1: the first");
  GltfMaker cycle = triangle_file();
  cycle.root["nodes"] = {
      {{"mesh", 0}, {"children", {1}}}, {{"children", {2}}}, {{"children", {1}}}};
  EXPECT_EQ(Loaded(cycle).count("nodes[1]: a cycle"), 1u);
}

TEST(GltfErrors, WrongPartsOfATransformationAreLeftOut) {
  expect_warning_with("/nodes/0/rotation", {0, 0, 0, 0},
                      "nodes[0].rotation: expected a quaternion");
  expect_warning_with("/nodes/0/rotation", {0, 0, 1}, "nodes[0].rotation: expected 4 finite");
  expect_warning_with("/nodes/0/scale", {1, 2}, "nodes[0].scale: expected 3 finite");
  expect_warning_with("/nodes/0/scale", "x", "nodes[0].scale: expected a number");
  expect_warning_with("/nodes/0/translation", {1, 2, 1e300}, "nodes[0].translation: expected 3");
  expect_warning_with("/nodes/0/matrix", {1, 2, 3}, "nodes[0].matrix: expected 16");
  expect_warning_with("/nodes/0/matrix",
                      Json::array({1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}), "last row");
  // The other parts stay.
  GltfMaker maker = triangle_file();
  maker.root["nodes"][0].update(
      {{"translation", {5, 6, 7}}, {"rotation", {0, 0, 0, 0}}, {"scale", {2, 3, 4}}});
  const Mesh mesh = Loaded(maker).scene.meshes.at(0);
  EXPECT_EQ(mesh.positions[1], Vec3(7, 6, 7));
  EXPECT_EQ(mesh.positions[2], Vec3(5, 12, 7));
}

// Beyond the numbers of 32 bits: what cannot be placed is lost, and the rest is not.
TEST(GltfErrors, WhatOverflowsIsLeftOut) {
  GltfMaker maker = triangle_file();
  const Json huge = {1e30, 1e30, 1e30};
  maker.root["nodes"] = {{{"mesh", 0}},
                         {{"scale", huge}, {"children", {2}}},
                         {{"scale", huge}, {"children", {3}}},
                         {{"scale", {0, 0, 0}}, {"mesh", 0}}};
  maker.root["scenes"][0]["nodes"] = {0, 1};
  const Loaded nested(maker);
  EXPECT_EQ(nested.count("nodes[2]: its transformation overflows"), 1u);
  EXPECT_EQ(nested.scene.meshes.size(), 1u);
  EXPECT_TRUE(nested.scene.instances.empty()) << "its child is lost, too";
  maker.root["nodes"] = {{{"mesh", 0}}, {{"mesh", 1}, {"scale", {1, 3e38, 1}}}};
  const int positions =
      maker.floats({0, 0, 0, 1, 0, 0, 0, 2, 0, 5, 0, 0, 6, 0, 0, 5, 0, 1}, "VEC3");
  maker.mesh({{"attributes", {{"POSITION", positions}}}});
  const Loaded vertex(maker);
  EXPECT_EQ(vertex.count("nodes[1]: a vertex in world space overflows"), 1u);
  ASSERT_EQ(vertex.scene.meshes.size(), 2u);
  EXPECT_EQ(vertex.scene.meshes[1].triangles.size(), 1u);
  for (const Vec3& p : vertex.scene.meshes[1].positions) EXPECT_TRUE(std::isfinite(p.y));
}

TEST(GltfErrors, AMeshLosesWhatCannotBeDrawn) {
  expect_warning_with("/meshes/0/primitives/0/material", 7, "materials[7] does not exist");
  const auto with_indices = [](std::initializer_list<std::uint16_t> indices) {
    GltfMaker maker = triangle_file();
    maker.root["meshes"][0]["primitives"][0]["indices"] = maker.indices(indices);
    return Loaded(maker);
  };
  const Loaded beyond = with_indices({0, 1, 2, 0, 2, 3, 0, 2, 1});
  EXPECT_EQ(beyond.scene.meshes.at(0).triangles.size(), 2u);
  EXPECT_EQ(beyond.count("indices: index 3, there are 3 vertices: its triangles are left out"), 1u);
  const Loaded five = with_indices({0, 1, 2, 0, 2});
  EXPECT_EQ(five.scene.meshes.at(0).triangles.size(), 1u);
  EXPECT_EQ(five.count("5 vertices: expected three for each triangle"), 1u);
  GltfMaker infinite;
  const int positions =
      infinite.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, HUGE_VALF, 0, 0, 7, 0, 0, 0, 7, 0}, "VEC3");
  infinite.mesh({{"attributes", {{"POSITION", positions}}}});
  const Loaded loaded(infinite);
  EXPECT_EQ(loaded.scene.meshes.at(0).triangles.size(), 1u);
  EXPECT_EQ(loaded.count("vertex 3 is not finite"), 1u);
  for (const Vec3& p : loaded.scene.meshes[0].positions) EXPECT_TRUE(std::isfinite(p.x));
  GltfMaker other = triangle_file();
  other.root["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 7}});
  EXPECT_EQ(Loaded(other).count("primitives[1].mode: 7: expected 0 to 6"), 1u);
}

// A mesh and what is said of it, once.
TEST(GltfErrors, WhatAMeshLacksIsSaid) {
  const auto with = [](const char* name, std::initializer_list<float> values) {
    GltfMaker maker = triangle_file();
    maker.root["meshes"][0]["primitives"][0]["attributes"][name] =
        maker.floats(values, values.size() == 12 ? "VEC4" : "VEC3");
    return maker;
  };
  GltfMaker nowhere = triangle_file();
  nowhere.root["meshes"][0]["primitives"].push_back({{"attributes", Json::object()}});
  GltfMaker without_number = triangle_file();
  without_number.root["nodes"][0]["extensions"] = {{"KHR_lights_punctual", Json::object()}};
  without_number.root["extensions"] = {
      {"KHR_lights_punctual", {{"lights", {{{"type", "point"}}}}}}};
  const std::tuple<GltfMaker, const char*, std::size_t> cases[] = {
      {with("NORMAL", {0, 0, 1, 0, 0, 0, 0, 0, 1}), "normals without a direction: the mesh is flat",
       1},
      {with("NORMAL", {0, 0, 1, 0, 0, 1e-3f, 0, 0, 9}), "normals", 0},
      {with("COLOR_0", {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}), "alpha of vertices", 0},
      {with("COLOR_0", {1, 1, 1, 1, 1, 1, 1, 0.99f, 1, 1, 1, 1}),
       "the alpha of vertices is ignored", 1},
      {nowhere, "meshes[0].primitives[1]: a primitive without POSITION is ignored", 1},
      {without_number, "nodes[0]: extensions.KHR_lights_punctual.lights[-1] does not exist", 1}};
  for (const auto& [maker, message, count] : cases) {
    const Loaded loaded(maker);
    EXPECT_EQ(loaded.count(message), count) << message << testing::PrintToString(loaded.messages);
  }
}

TEST(GltfErrors, NumbersAndFlagsOfTheWrongFormAreLeftOut) {
  expect_warning_with("/materials/0/doubleSided", 1, "materials[0].doubleSided: expected true or");
  expect_warning_with("/materials/0/alphaCutoff", "x",
                      "materials[0].alphaCutoff: expected a number");
  expect_warning_with("/materials/0/alphaMode", "GLASS",
                      "materials[0].alphaMode: 'GLASS': expected OPAQUE, MASK or BLEND");
  expect_warning_with("/materials/0/emissiveFactor", {1, 1}, "emissiveFactor: expected");
  expect_warning_with("/materials/0/emissiveFactor", {1, -1, 1}, "emissiveFactor: expected finite");
  expect_warning_with("/materials/0/pbrMetallicRoughness", {{"baseColorFactor", {1, 1}}},
                      "baseColorFactor: expected another number of components");
  expect_warning_with("/materials/0/extensions", {{"KHR_materials_ior", {{"ior", 0.5}}}},
                      "0.5: expected 0 or a number >= 1");
  expect_warning_with("/materials/0/extensions", {{"KHR_materials_ior", {{"ior", "x"}}}},
                      "KHR_materials_ior.ior: expected");
  // Three components, as some write them, are opaque.
  GltfMaker maker = with_material(
      {{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 1, 1}}}}});
  const MaterialDescription material = Loaded(maker, true).scene.materials.at(0);
  EXPECT_EQ(material.color(0), Color(0.5f, 1, 1));
  EXPECT_TRUE(material.opacity.is_opaque());
}

TEST(GltfErrors, LongNamesAreClipped) {
  GltfMaker maker = triangle_file();
  maker.root["extensionsUsed"] = {std::string(5 << 20, 'x')};
  maker.root["images"] = {{{"uri", std::string(5 << 20, 'y') + ".png"}}};
  maker.root["textures"] = {{{"source", 0}}};
  maker.root["materials"] = {{{"name", std::string(5 << 20, 'z')},
                              {"alphaMode", std::string(5 << 20, 'a')},
                              {"emissiveFactor", {1, 1, 1}},
                              {"emissiveTexture", {{"index", 0}}}}};
  maker.root["meshes"][0]["primitives"][0]["material"] = 0;
  const Loaded loaded(maker);
  EXPECT_GE(loaded.messages.size(), 3u);
  for (const std::string& message : loaded.messages) EXPECT_LT(message.size(), 1000u);
  const auto message_of = [](const GltfMaker& bad) -> std::string {
    try {
      Loaded loaded_bad(bad);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  maker.root["meshes"][0][std::string(5 << 20, 'k')] = {{"indices", "x"}};
  EXPECT_LT(message_of(maker).size(), 1000u);
  GltfMaker buffer = triangle_file();
  buffer.root["buffers"] = Json::array();
  buffer.root["extensionsRequired"] = {std::string(5 << 20, 'r')};
  EXPECT_LT(message_of(buffer).size(), 1000u);
  EXPECT_NE(message_of(buffer), "no error");
}

TEST(GltfErrors, LongChainsOfNodesAreNoTrouble) {
  GltfMaker maker = triangle_file();
  maker.root["nodes"] = Json::array();
  constexpr int length = 50000;
  for (int i = 0; i < length - 1; ++i) maker.root["nodes"].push_back({{"children", {i + 1}}});
  maker.root["nodes"].push_back({{"mesh", 0}});
  EXPECT_EQ(Loaded(maker).scene.meshes.size(), 1u);
}

TEST(GltfErrors, Extensions) {
  GltfMaker maker = triangle_file();
  maker.root["extensionsUsed"] = {"KHR_draco_mesh_compression", "KHR_materials_unlit"};
  EXPECT_EQ(Loaded(maker).count("KHR_draco_mesh_compression is ignored"), 1u);
  EXPECT_EQ(Loaded(maker).count("extensionsUsed"), 1u);
  maker.root["extensionsRequired"] = {"KHR_materials_unlit", "KHR_materials_clearcoat",
                                      "KHR_materials_sheen", "KHR_materials_specular"};
  EXPECT_NO_THROW(Loaded{maker});
  maker.root["extensionsRequired"].push_back("KHR_draco_mesh_compression");
  expect_load_error(maker.gltf(), "KHR_draco_mesh_compression is not supported");
}

TEST(GltfErrors, Buffers) {
  const GltfMaker maker = triangle_file();
  const auto with_uri = [&](const std::string& uri) { return maker.with_buffer(uri).dump(); };
  const std::string header = "data:application/octet-stream;base64,";
  const std::string data = base64(maker.buffer);
  expect_load_error(with_uri("absent.bin"), "absent.bin");
  expect_load_error(with_uri(""), "uri");
  expect_load_error(with_uri(header + data.substr(0, 20)), "decode");
  expect_load_error(with_uri(header + data + data), "decode");
  expect_load_error(with_uri(header + "*" + data.substr(1)),
                    "buffers[0].uri: invalid base64 at character 0");
  expect_load_error(with_uri(header + data.substr(0, 4) + " " + data.substr(5)),
                    "buffers[0].uri: invalid base64 at character 4");
  expect_load_error(with_uri("data:application/octet-stream," + data), "buffers[0].uri");
  expect_load_error(with_uri("data:video/mp4;base64," + data), "buffers[0].uri");
  TempFolder folder;
  write_text(folder.file("scene.gltf"), with_uri("short.bin"));
  write_text(folder.file("short.bin"), maker.buffer.substr(1));
  expect_error([&] { load_gltf(folder.file("scene.gltf"), {}); }, "short.bin");
}

TEST(GltfErrors, ImagesAndTextures) {
  GltfMaker maker = triangle_file();
  maker.root["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  maker.root["meshes"][0]["primitives"][0]["material"] = 0;
  const auto expect_warning = [&](const std::string& part) {
    const Loaded loaded(maker);
    EXPECT_GE(loaded.count(part), 1u) << part << ": " << testing::PrintToString(loaded.messages);
    EXPECT_EQ(loaded.count("the factor alone is used"), 1u) << part;
  };
  expect_warning("materials[0].pbrMetallicRoughness.baseColorTexture.index: textures[0]");
  maker.root["textures"] = {{{"source", 0}}};
  expect_warning("textures[0].source: images[0] does not exist");
  maker.root["images"] = {{{"bufferView", 9}}};
  expect_warning("images[0]: bufferViews[9] does not exist");
  maker.root["images"] = {{{"bufferView", 0}}};  // no image
  expect_warning("images[0]");
  maker.root["images"] = {Json::object()};
  expect_warning("images[0]: neither uri nor bufferView");
  for (const char* uri :
       {"data:image/png;base64,", "data:image/png;base64,*", "data:image/png,%89PNG", "data:x",
        "data:image/webp;base64,AAAA", "data:;base64,AAAA"}) {
    maker.root["images"] = {{{"uri", uri}}};
    expect_warning("images[0]");
  }
}

TEST(GltfErrors, OtherVersionsAndCompressionsAreNamed) {
  expect_load_error(
      R"({"asset": {"version": "1.0"}, "accessors": {}, "meshes": {"m": {"primitives": []}}})",
      "asset.version: 1.0: this version of glTF is not supported");
  expect_load_error(R"({"accessors": {}, "meshes": {"m": {"primitives": []}}})", "glTF 1.0");
  std::string glb = triangle_file().glb();
  glb[4] = 1;
  expect_load_error(glb, "header: version 1 of .glb, as in glTF 1.0, is not supported");
  // Compressed, with no other data.
  GltfMaker draco = triangle_file();
  draco.root["meshes"][0]["primitives"][0]["indices"] =
      draco.indices(std::initializer_list<std::uint16_t>{0, 1, 2});
  draco.root["meshes"][0]["primitives"][0]["extensions"] = {
      {"KHR_draco_mesh_compression", {{"bufferView", 0}, {"attributes", {{"POSITION", 0}}}}}};
  EXPECT_EQ(Loaded(draco).scene.meshes.size(), 1u) << "data beside it are used";
  for (Json& accessor : draco.root["accessors"]) accessor.erase("bufferView");
  expect_load_error(draco.gltf(), "KHR_draco_mesh_compression is not supported");
  draco.root["meshes"][0]["primitives"][0].erase("indices");
  expect_load_error(draco.gltf(), "KHR_draco_mesh_compression is not supported");
  draco.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  expect_load_error(draco.gltf(), "extensionsRequired: KHR_draco_mesh_compression is not");
  Json meshopt = triangle_file().with_buffer("data:application/octet-stream;base64,AAAA");
  meshopt["buffers"].push_back(
      {{"byteLength", 36}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
  expect_load_error(meshopt.dump(), "buffers[1].uri: missing: the data is in EXT_meshopt");
  meshopt["extensionsRequired"] = {"EXT_meshopt_compression"};
  expect_load_error(meshopt.dump(), "extensionsRequired: EXT_meshopt_compression is not");
  expect_load_error(triangle_file().with_buffer("").dump(), "buffers[0].uri: missing");
}

TEST(GltfErrors, OnlyRegularFilesAreRead) {
  TempFolder folder;
  const std::string pipe = folder.file("pipe");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& path : {pipe, std::string("/dev/zero"), folder.file("")}) {
    expect_error([&] { load_gltf(path, {}); }, "not a regular file");
  }
  write_text(folder.file("scene.gltf"), triangle_file().with_buffer("pipe").dump());
  expect_error([&] { load_gltf(folder.file("scene.gltf"), {}); }, "not a regular file");
  // A picture is only a warning.
  GltfMaker maker =
      with_material({{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", {{"index", 0}}}});
  maker.root["textures"] = {{{"source", 0}}};
  maker.root["images"] = {{{"uri", "pipe"}}};
  write_text(folder.file("scene.gltf"), maker.gltf());
  std::size_t warned = 0;
  LoadOptions options;
  options.warn = [&](const std::string& line) {
    warned += line.find("cannot read 'pipe'") != line.npos;
  };
  EXPECT_EQ(load_gltf(folder.file("scene.gltf"), options).meshes.size(), 1u);
  EXPECT_EQ(warned, 1u);
}

// Each alone would be allowed.
TEST(GltfErrors, ZerosOfAWholeFileAreLimited) {
  GltfMaker maker = triangle_file();
  const int indices = maker.indices(std::initializer_list<std::uint32_t>{0, 1, 2});
  const int zeros =
      maker.push("accessors", {{"componentType", 5126}, {"count", 1 << 22}, {"type", "VEC3"}});
  maker.root["accessors"][zeros]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", 1}, {"componentType", 5125}}},
      {"values", {{"bufferView", 0}}}};
  for (int i = 0; i < 20; ++i) {
    maker.root["meshes"][0]["primitives"].push_back(
        {{"attributes", {{"POSITION", zeros}}}, {"indices", indices}});
  }
  expect_load_error(maker.gltf(), "elements without a bufferView: expected at most 16777216 in a");
}

/// Prefixes of a .glb file, and copies with a byte changed, are an Error or a scene. (All prefixes
/// and all changes were tried once with the sanitizers; a prime step keeps the test quick.)
TEST(GltfErrors, NoDamageToABinaryFileCrashes) {
  GltfMaker maker = triangle_file();
  maker.root["meshes"][0]["primitives"][0]["indices"] =
      maker.indices(std::initializer_list<std::uint16_t>{0, 1, 2});
  const std::string glb = maker.glb();
  TempFolder folder;
  const std::string path = folder.file("scene.glb");
  const auto load = [&](const std::string& content) {
    write_text(path, content);
    try {
      load_gltf(path, {});
      return true;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      return false;
    }
  };
  EXPECT_TRUE(load(glb));
  for (std::size_t size = 0; size < glb.size(); size += 7) {
    EXPECT_FALSE(load(glb.substr(0, size))) << size << " bytes";
  }
  std::size_t errors = 0, copies = 0;
  for (std::size_t i = 0; i < glb.size(); i += 3) {
    std::string damaged = glb;
    const unsigned change = i % 2 ? 0x80u : 1u;
    damaged[i] = static_cast<char>(static_cast<unsigned char>(damaged[i]) ^ change);
    errors += !load(damaged);
    ++copies;
  }
  EXPECT_GT(errors, copies / 2);
}

}  // namespace
}  // namespace pt
