// The glTF loader: files that are malformed get one line, never a crash.
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
  expect_error_with("/meshes/0/primitives/0/material", 0, "materials[0] does not exist");
  expect_error_with("/meshes/0/primitives", 3, "meshes[0].primitives: expected an array");
  expect_error_with("/accessors/1/count", 2, "meshes[0].primitives[0]");
  GltfMaker maker = triangle_file();
  maker.root["meshes"][0]["primitives"][0]["indices"] =
      maker.indices(std::initializer_list<std::uint8_t>{0, 1, 255});
  expect_load_error(maker.gltf(), "meshes[0].primitives[0].indices: entry 2 is 255");
  GltfMaker infinite;
  infinite.mesh({{"attributes",
                  {{"POSITION", infinite.floats({0, 0, 0, 1, HUGE_VALF, 0, 0, 1, 0}, "VEC3")}}}});
  expect_load_error(infinite.gltf(), "vertex 1 is not finite");
}

TEST(GltfErrors, NodesFormTrees) {
  expect_error_with("/nodes/0/children", {0}, "nodes[0]: a cycle");
  expect_error_with("/nodes/0/children", {5}, "nodes[0].children: nodes[5] does not exist");
  expect_error_with("/nodes/0/mesh", 5, "nodes[0].mesh: meshes[5] does not exist");
  expect_error_with("/scenes/0/nodes", {0, 0}, "nodes[0]: a cycle or two parents");
  expect_error_with("/scene", 2, "scenes[2] does not exist");
  expect_error_with("/nodes/0/rotation", {0, 0, 0, 0}, "nodes[0].rotation");
  expect_error_with("/nodes/0/scale", {1, 2}, "nodes[0].scale");
  expect_error_with("/nodes/0/scale", "x", "nodes[0].scale");
  expect_error_with("/nodes/0/translation", {1, 2, 1e300}, "nodes[0].translation");
  expect_error_with("/nodes/0/matrix", {1, 2, 3}, "nodes[0].matrix");
  expect_error_with("/nodes/0/matrix",
                    Json::array({1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}), "last row");
  GltfMaker cycle = triangle_file();
  cycle.root["nodes"] = {
      {{"mesh", 0}, {"children", {1}}}, {{"children", {2}}}, {{"children", {1}}}};
  expect_load_error(cycle.gltf(), "nodes[1]: a cycle");
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
  expect_load_error(maker.gltf(), "materials[0].pbrMetallicRoughness.baseColorTexture.index");
  maker.root["textures"] = {{{"source", 0}}};
  expect_load_error(maker.gltf(), "textures[0].source");
  maker.root["images"] = {{{"bufferView", 9}}};
  expect_load_error(maker.gltf(), "bufferView");
  maker.root["images"] = {{{"bufferView", 0}}};  // no image
  EXPECT_EQ(Loaded(maker).count("images[0]"), 1u);
  maker.root["images"] = {Json::object()};
  expect_load_error(maker.gltf(), "image[0]");
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
