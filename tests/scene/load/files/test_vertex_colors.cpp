// Colours of vertices and faces: PLY, OBJ, glTF, Mitsuba's mesh_attribute, and the texture that
// they become.
#include <cmath>
#include <random>

#include "common/geometry/mesh.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/files/meshes/vertex_colors.h"
#include "common/scene/load/load_scene.h"
#include "common/texture/sample_texture.h"
#include "load/expect_near.h"
#include "load/gltf_files.h"
#include "load/mesh_bytes.h"
#include "load/obj_files.h"

namespace pt {
namespace {

/// IEC 61966-2-1, as its text has it.
float linear(double byte) {
  const double c = byte / 255.0;
  return static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
}

/// What a parameter of the mesh's material is at a point of a triangle.
Color shown(const SceneData& scene, std::size_t mesh, std::uint32_t triangle, const Vec3& b,
            const Parameter& p) {
  if (p.texture == no_texture) return p.value;
  const Mesh& m = scene.meshes[mesh];
  CornerAttributes corners;
  for (int i = 0; i < 3; ++i) corners.uv[i] = m.uvs[m.triangles[triangle].v[i]];
  const Vec2 uv = corners.uv_at(b);
  return p.value * sample_texture(scene.textures.at(p.texture), scene.texels.data(), uv);
}

Color reflectance(const SceneData& scene, std::uint32_t triangle, const Vec3& b) {
  const MaterialDescription& material = scene.materials.at(scene.meshes.at(0).material);
  return shown(scene, 0, triangle, b, material.parameters[0]);
}

const Vec3 corners[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const Vec3 middle(1.0f / 3.0f);

struct LoadedFile {
  std::vector<std::string> messages;
  SceneData scene;

  LoadedFile(const std::string& name, const std::string& text, const std::string& ply = "") {
    const TempFolder folder;
    write_text(folder.file(name), text);
    if (!ply.empty()) write_text(folder.file("a.ply"), ply);
    LoadOptions options;
    options.warn = [this](const std::string& message) { messages.push_back(message); };
    scene = load_scene_file(folder.file(name), options);
  }

  std::size_t count(const std::string& part) const {
    return static_cast<std::size_t>(std::ranges::count_if(
        messages,
        [&](const std::string& message) { return message.find(part) != std::string::npos; }));
  }
};

/// Unconnected triangles at random places, black and white among their random colours.
Mesh random_mesh(std::uint32_t triangles, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto number = [&] { return static_cast<float>(random() % 5) / 4.0f; };
  Mesh mesh;
  for (std::uint32_t v = 0; v < triangles + 2; ++v) {
    mesh.positions.emplace_back(number(), number(), number());
    mesh.colors.emplace_back(number(), number(), number());
  }
  for (std::uint32_t i = 0; i < triangles; ++i) {
    mesh.triangles.push_back({{i, static_cast<std::uint32_t>(random() % (triangles + 2)), i + 2}});
  }
  return mesh;
}

TEST(VertexColors, AreLinearOverTriangles) {
  SceneData scene;
  VertexColors colors(scene, {});
  const std::uint32_t material = scene.add_material(make_diffuse(Color(1.0f)));
  for (const std::uint32_t triangles : {1000u, 4000u}) {
    scene.meshes.push_back(random_mesh(triangles, triangles));
    scene.meshes.back().material = material;
    colors.tint(scene.meshes.back(), false, "");
  }
  const std::vector<Mesh> before = scene.meshes;
  colors.finish();
  const Parameter& parameter = scene.materials.at(before[0].material).parameters[0];
  // 128 triangles, 256 texels a row: corners are 2^-14 texels off, twice (color_atlas.cpp).
  const float tolerance = 2.5f * std::exp2(-14.0f);
  std::mt19937 random(7);
  for (std::size_t m = 0; m < 2; ++m) {
    const Mesh &old = before[m], &mesh = scene.meshes[m];
    ASSERT_EQ(mesh.material, before[0].material);
    ASSERT_EQ(mesh.triangles.size(), old.triangles.size());
    EXPECT_TRUE(mesh.colors.empty());
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      float x = static_cast<float>(random() % 1025) / 1024.0f;
      float y = static_cast<float>(random() % 1025) / 1024.0f;
      if (x + y > 1.0f) x = 1.0f - x, y = 1.0f - y;
      const Vec3 b(1.0f - x - y, x, y);
      Color expected(0.0f);
      for (int k = 0; k < 3; ++k) {
        expected += b[k] * old.colors[old.triangles[i].v[k]];
        ASSERT_EQ(mesh.positions[mesh.triangles[i].v[k]], old.positions[old.triangles[i].v[k]]);
      }
      const Color color = shown(scene, m, i, b, parameter);
      expect_near(color, expected, tolerance);
      ASSERT_TRUE(color.x >= 0.0f && color.y >= 0.0f && color.z >= 0.0f) << i;
    }
  }
}

/// A quad whose vertices have colours of this type.
std::string quad(const std::string& type, const std::string& colors, const char* names = "rgb",
                 const std::string& face_properties = "", const std::string& face = "") {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n"
      "property float y\nproperty float z\n";
  for (const char* name = names; !type.empty() && *name; ++name) {
    const bool is_long = names[3] != 0;
    text += "property " + type + " " +
            (is_long ? std::vector<std::string>{"red", "green", "blue"}[name - names]
                     : std::string(1, *name)) +
            "\n";
    if (name - names == 2) break;
  }
  text +=
      "element face 1\nproperty list uchar int vertex_indices\n" + face_properties + "end_header\n";
  std::size_t at = 0;
  for (const char* position : {"0 0 0 ", "1 0 0 ", "1 1 0 ", "0 1 0 "}) {
    const std::size_t end = colors.find(',', at);
    text += position + (colors.empty() ? "" : colors.substr(at, end - at)) + "\n";
    at = end + 1;
  }
  return text + "4 0 1 2 3 " + face + "\n";
}

constexpr const char* bytes = "255 0 0,0 255 0,0 0 188,10 20 30,";
constexpr const char* floats = "1 0 0,0 0.5 0,0 0 0.25,0.1 0.2 0.3,";

TEST(VertexColors, PlyHasBytesInTheCurveAndLinearFloats) {
  for (const char* names : {"rgb", "red green blue"}) {
    const SceneData integers = LoadedFile("a.ply", quad("uchar", bytes, names)).scene;
    expect_near(reflectance(integers, 0, corners[0]), {1, 0, 0});
    expect_near(reflectance(integers, 0, corners[2]), {0, 0, linear(188)});
    expect_near(reflectance(integers, 1, corners[2]), {linear(10), linear(20), linear(30)});
    expect_near(reflectance(integers, 0, middle), Color(1, 1, linear(188)) / 3.0f);
    const SceneData numbers = LoadedFile("a.ply", quad("float", floats, names)).scene;
    expect_near(reflectance(numbers, 0, corners[1]), {0, 0.5f, 0});
    expect_near(reflectance(numbers, 1, {0.5f, 0.25f, 0.25f}), {0.525f, 0.05f, 0.1375f});
  }
  const SceneData grey = LoadedFile("a.ply", quad("", "")).scene;
  EXPECT_EQ(reflectance(grey, 0, middle), Color(0.5f));
}

TEST(VertexColors, BinaryPly) {
  MeshBytes file(true);
  for (const float x : {0.0f, 1.0f, 0.0f}) {
    file.put(x).put(1.0f - x).put(2.0f);
    for (const float share : {1.0f, x, 0.5f}) {
      file.put(static_cast<std::uint16_t>(std::lround(65535.0f * share)));
    }
  }
  file.put(std::uint8_t{3}).put(0).put(1).put(2);
  const std::string header =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nproperty ushort red\nproperty ushort green\nproperty ushort blue\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const SceneData scene = LoadedFile("a.ply", header + file.text).scene;
  expect_near(reflectance(scene, 0, corners[0]), {1, 0, linear(127.5)});
  expect_near(reflectance(scene, 0, middle), {1, 1.0f / 3.0f, linear(127.5)});
}

TEST(VertexColors, ObjHasThemBehindPositions) {
  const std::string text =
      "v 0 0 0 1 0 0\nv 1 0 0 0 0.5 0\nv 0 1 0 1.0 0 0 1 # a weight, blue\nv 1 1 0 # none\n"
      "f 1 2 3\nf 2 4 3\n";
  const LoadedFile loaded("a.obj", text);
  expect_near(reflectance(loaded.scene, 0, corners[0]), {0.5f, 0, 0});  // of the grey material
  expect_near(reflectance(loaded.scene, 0, corners[1]), {0, 0.5f * linear(127.5), 0});
  expect_near(reflectance(loaded.scene, 0, corners[2]), {0, 0, 0.5f});
  expect_near(reflectance(loaded.scene, 1, corners[1]), Color(0.5f));
}

/// The triangle with COLOR_0 in this accessor.
GltfMaker with_colors(GltfMaker maker, int accessor, bool normalized = false) {
  maker.root["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = accessor;
  if (normalized) maker.root["accessors"][accessor]["normalized"] = true;
  return maker;
}

GltfMaker with_float_colors(GltfMaker maker) {
  const int accessor = maker.floats({1, 0, 0, 0, 0.5f, 0, 0, 0, 0.25f}, "VEC3");
  return with_colors(maker, accessor);
}

const Json half_base = {{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 1, 1, 1}}}}};

TEST(VertexColors, GltfMultipliesTheBaseColour) {
  const SceneData scene = Loaded(with_float_colors(with_material(half_base))).scene;
  expect_near(reflectance(scene, 0, corners[0]), {0.5f, 0, 0});
  expect_near(reflectance(scene, 0, middle), {0.5f / 3, 0.5f / 3, 0.25f / 3});
  const MaterialDescription& material = scene.materials.at(scene.meshes[0].material);
  EXPECT_EQ(material.kind, kind_of<Principled>);
  EXPECT_EQ(material.parameters[1].texture, no_texture);

  GltfMaker maker = with_material(half_base);
  using Bytes = std::initializer_list<std::uint8_t>;
  const int rgba = maker.accessor(
      maker.view(bytes_of(Bytes{255, 0, 0, 255, 0, 102, 0, 255, 51, 0, 0, 255})), 5121, 3, "VEC4");
  const SceneData integers = Loaded(with_colors(maker, rgba, true)).scene;
  expect_near(reflectance(integers, 0, corners[1]), {0, 0.4f, 0});
  expect_near(reflectance(integers, 0, corners[2]), {0.1f, 0, 0});
}

TEST(VertexColors, OneColourIsAFactor) {
  GltfMaker maker = with_material(half_base);
  const int accessor = maker.floats({0.5f, 0.25f, 1, 0.5f, 0.25f, 1, 0.5f, 0.25f, 1}, "VEC3");
  const Loaded loaded(with_colors(maker, accessor));
  const MaterialDescription& m = loaded.scene.materials.at(loaded.scene.meshes[0].material);
  expect_near(m.color(0), {0.25f, 0.25f, 1});
  EXPECT_FALSE(m.is_textured());
}

TEST(VertexColors, BesideATextureTheMeanIsUsed) {
  GltfMaker maker = with_material(half_base);
  maker.root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
  std::string tga(18, '\0');  // true colour, 24 bits, one texel
  tga[2] = 2, tga[12] = 1, tga[14] = 1, tga[16] = 24;
  const int view = maker.view(tga + std::string(3, static_cast<char>(255)));
  maker.root["images"] = {{{"bufferView", view}, {"mimeType", "image/png"}}};
  maker.root["textures"] = {{{"source", 0}}};
  const Loaded loaded(with_float_colors(maker));
  const MaterialDescription& m = loaded.scene.materials.at(loaded.scene.meshes[0].material);
  expect_near(m.color(0), {0.5f / 3, 0.5f / 3, 0.25f / 3});
  EXPECT_TRUE(m.is_textured());
  EXPECT_EQ(loaded.count("their mean is used"), 1u);
}

TEST(VertexColors, UnlitEmitsThem) {
  Json unlit = half_base;
  unlit["extensions"] = {{"KHR_materials_unlit", Json::object()}};
  const SceneData scene = Loaded(with_float_colors(with_material(unlit))).scene;
  const Emission& emission = scene.materials.at(scene.meshes[0].material).emission;
  const Parameter emitted{emission.radiance, emission.texture};
  expect_near(shown(scene, 0, 0, corners[0], emitted), {0.5f, 0, 0});
  expect_near(shown(scene, 0, 0, corners[2], emitted), {0, 0, 0.25f});
  EXPECT_TRUE(is_black(reflectance(scene, 0, corners[0])));
}

std::string attribute_scene(const std::string& name, const std::string& more = "") {
  return "<scene version='3.0.0'><shape type='ply'><string name='filename' value='a.ply'/>"
         "<bsdf type='twosided'><bsdf type='diffuse'>"
         "<texture type='mesh_attribute' name='reflectance'>"
         "<string name='name' value='" +
         name + "'/><float name='scale' value='0.5'/></texture>" + more +
         "</bsdf></bsdf></shape></scene>";
}

TEST(VertexColors, MitsubasMeshAttributes) {
  const LoadedFile vertices("a.xml", attribute_scene("vertex_color"), quad("float", floats));
  expect_near(reflectance(vertices.scene, 0, corners[1]), {0, 0.25f, 0});
  expect_near(reflectance(vertices.scene, 1, middle), Color(1.1f, 0.2f, 0.55f) / 6.0f);
  const LoadedFile faces(
      "a.xml", attribute_scene("face_color"),
      quad("float", floats, "rgb", "property float r\nproperty float g\nproperty float b\n",
           "0.2 0.4 0.8"));
  expect_near(reflectance(faces.scene, 0, middle), {0.1f, 0.2f, 0.4f});
  expect_near(reflectance(faces.scene, 1, corners[2]), {0.1f, 0.2f, 0.4f});
  const LoadedFile none("a.xml", attribute_scene("vertex_color"), quad("", ""));
  expect_near(reflectance(none.scene, 1, middle), Color(0.5f));
  EXPECT_EQ(none.count("no attribute 'vertex_color'"), 1u);
  EXPECT_EQ(vertices.count("attribute"), 0u);
  EXPECT_EQ(faces.count("attribute"), 0u);
  const LoadedFile unknown("a.xml", attribute_scene("vertex_dirt"), quad("float", floats));
  EXPECT_EQ(unknown.count("mesh_attribute 'vertex_dirt' is not supported"), 1u);
}

std::string replaced_all(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

// mi.Mesh.write_ply() of Mitsuba 3.9.1 calls the components of an attribute `color` by numbers.
std::string numbered(std::string ply) {
  const char* const names[3][2] = {{"red", "r"}, {"green", "g"}, {"blue", "b"}};
  for (int i = 0; i < 3; ++i) {
    for (const char* name : names[i]) {
      ply = replaced_all(ply, std::string(" ") + name + "\n", " color_" + std::to_string(i) + "\n");
    }
  }
  return ply;
}

TEST(VertexColors, AreFoundAsMitsubaWritesThem) {
  const std::string by_vertex = numbered(quad("float", floats));
  ASSERT_NE(by_vertex.find("property float color_2\n"), std::string::npos);
  const LoadedFile vertices("a.xml", attribute_scene("vertex_color"), by_vertex);
  expect_near(reflectance(vertices.scene, 0, corners[1]), {0, 0.25f, 0});
  EXPECT_EQ(vertices.count("attribute"), 0u);
  const LoadedFile faces(
      "a.xml", attribute_scene("face_color"),
      numbered(quad("float", floats, "rgb",
                    "property float r\nproperty float g\nproperty float b\n", "0.2 0.4 0.8")));
  expect_near(reflectance(faces.scene, 1, corners[2]), {0.1f, 0.2f, 0.4f});
  EXPECT_EQ(faces.count("attribute"), 0u);
}

// Texture coordinates of colours would turn the directions in which a surface is brushed.
TEST(VertexColors, BesideAnisotropyTheMeanIsUsed) {
  const ObjFolder folder;
  folder.write("a.mtl", "newmtl m\nKd 1 1 1\nPr 0.5\naniso 0.5\nnewmtl n\nKd 1 1 1\nPr 0.5\n");
  const std::string vertices = "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 0 0\nv 0 1 0 0.5 0.5 1\n";
  const LoadedObj brushed = folder.load(vertices + "usemtl m\nf 1 2 3\n");
  EXPECT_EQ(brushed.count("in an anisotropic material are not supported: their mean is used"), 1);
  const MaterialDescription& m = brushed.scene.materials.at(brushed.scene.meshes.at(0).material);
  EXPECT_FALSE(m.is_textured());
  expect_near(m.color(0), {(1 + linear(127.5)) / 3, linear(127.5) / 3, 1.0f / 3.0f});
  const LoadedObj plain = folder.load(vertices + "usemtl n\nf 1 2 3\n");
  EXPECT_TRUE(plain.warnings.empty());
  EXPECT_TRUE(plain.scene.materials.at(plain.scene.meshes.at(0).material).is_textured());
}

TEST(VertexColors, OfAnObjAreWhiteWhereTheFileHasNone) {
  const Mesh mesh = decode_obj("v 0 0 0\nv 1 0 0 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 3 2 4\n", "a");
  const Color white(1.0f), red(1, 0, 0);
  EXPECT_EQ(mesh.colors, (std::vector<Color>{white, red, white, white}));
  EXPECT_TRUE(decode_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a").colors.empty());
}

}  // namespace
}  // namespace pt
