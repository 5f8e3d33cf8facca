// PLY in the conventions of the programs that write it, by hand: names, types, byte order, comments
// and elements as these have them. All hold the same pyramid without its floor, or a part of it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "common/scene/load/files/meshes/mesh_files.h"
#include "load/mesh_bytes.h"

namespace pt {
namespace {

constexpr float positions[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.25f, 0.25f, 1}};
constexpr float normals[4][3] = {{-0.6f, -0.8f, 0}, {0.8f, 0, 0.6f}, {0, 0.6f, 0.8f}, {0, 0, 1}};
constexpr float uvs[4][2] = {{0, 0}, {1, 0.125f}, {0.5f, 1}, {0.25f, 0.75f}};
constexpr int colors[4][3] = {{255, 0, 0}, {0, 128, 0}, {0, 0, 64}, {255, 255, 255}};
constexpr int faces[3][3] = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

float from_srgb(double code) {
  return static_cast<float>(code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4));
}

struct Exporter {
  const char* program;
  std::string header;  ///< without the first and the last line
  std::function<std::string(MeshBytes&)> body;
  bool has_normals = false, has_uvs = false, has_colors = false, has_face_colors = false;
  std::vector<std::string> warnings = {};
  bool big_endian = false;
};

/// Vertices and faces in text. `more`: columns beside the position, of a vertex.
std::string text_body(const std::function<std::string(int)>& more,
                      const std::function<std::string(int)>& more_of_face = {}) {
  std::string text;
  for (int v = 0; v < 4; ++v) {
    text += fmt::format("{} {} {}{}\n", positions[v][0], positions[v][1], positions[v][2], more(v));
  }
  for (int f = 0; f < 3; ++f) {
    text += fmt::format("3 {} {} {}{}\n", faces[f][0], faces[f][1], faces[f][2],
                        more_of_face ? more_of_face(f) : "");
  }
  return text;
}

std::string normal_text(int v) {
  return fmt::format(" {} {} {}", normals[v][0], normals[v][1], normals[v][2]);
}
std::string uv_text(int v) { return fmt::format(" {} {}", uvs[v][0], uvs[v][1]); }
std::string color_text(int v) {
  return fmt::format(" {} {} {}", colors[v][0], colors[v][1], colors[v][2]);
}

void put_position(MeshBytes& out, int v) {
  for (const float x : positions[v]) out.put(x);
}
void put_faces(MeshBytes& out, const std::function<void(int)>& more = {}) {
  for (int f = 0; f < 3; ++f) {
    out.put<std::uint8_t>(3);
    for (const int v : faces[f]) out.put<std::int32_t>(v);
    if (more) more(f);
  }
}

const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
const std::string nxyz = "property float nx\nproperty float ny\nproperty float nz\n";
const std::string rgb8 = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
const std::string rgba8 = rgb8 + "property uchar alpha\n";
const std::string list = "property list uchar int vertex_indices\n";

std::vector<Exporter> exporters() {
  const auto elements = [](const std::string& vertex, const std::string& face) {
    return "element vertex 4\n" + vertex + "element face 3\n" + face;
  };
  const auto with_colors = [](int v) { return color_text(v) + " 255"; };
  return {
      {"Blender",
       "format ascii 1.0\ncomment Created by Blender 4.2.0, www.blender.org\n" +
           elements(xyz + nxyz + "property float s\nproperty float t\n",
                    "property list uchar uint vertex_indices\n"),
       [](MeshBytes&) { return text_body([](int v) { return normal_text(v) + uv_text(v); }); },
       true, true},
      {"Blender, binary with colours and loose edges",
       "format binary_little_endian 1.0\ncomment Created in Blender version 4.2.0\n" +
           elements(xyz + nxyz + rgba8 + "property float s\nproperty float t\n",
                    "property list uchar uint vertex_indices\n") +
           "element edge 1\nproperty int vertex1\nproperty int vertex2\n",
       [](MeshBytes& out) {
         for (int v = 0; v < 4; ++v) {
           put_position(out, v);
           for (const float x : normals[v]) out.put(x);
           for (const int c : colors[v]) out.put(static_cast<std::uint8_t>(c));
           out.put<std::uint8_t>(255).put(uvs[v][0]).put(uvs[v][1]);
         }
         put_faces(out);
         out.put(0).put(1);
         return out.text;
       },
       true, true, true},
      {"MeshLab, with coordinates of faces",
       "format ascii 1.0\ncomment VCGLIB generated\ncomment TextureFile skin.png\n" +
           elements(xyz + nxyz + rgba8 + "property float quality\n",
                    list + "property list uchar float texcoord\nproperty int texnumber\n"),
       [=](MeshBytes&) {
         return text_body([=](int v) { return normal_text(v) + with_colors(v) + " 0.5"; },
                          [](int) { return std::string(" 6 0 0 1 0 1 1 0"); });
       },
       true,
       false,
       true,
       false,
       {"the picture that it names is ignored",
        "texture coordinates of faces are not supported and ignored; expected u and v of "
        "vertices"}},
      {"VCGlib, with coordinates of vertices",
       "format binary_little_endian 1.0\ncomment VCGLIB generated\n" +
           elements(
               xyz + "property int flags\nproperty float texture_u\nproperty float texture_v\n",
               list + "property int flags\n"),
       [](MeshBytes& out) {
         for (int v = 0; v < 4; ++v) {
           put_position(out, v);
           out.put(7).put(uvs[v][0]).put(uvs[v][1]);
         }
         put_faces(out, [&](int) { out.put(0); });
         return out.text;
       },
       false, true},
      {"Stanford's zippered scans",
       "format ascii 1.0\ncomment zipper output\n" +
           elements(xyz + "property float confidence\nproperty float intensity\n", list),
       [](MeshBytes&) { return text_body([](int) { return std::string(" 0.75 0.5"); }); }},
      {"Stanford's VRIP, big-endian strips",
       "format binary_big_endian 1.0\nobj_info vripped with 5 files\nelement vertex 4\n" + xyz +
           "property uchar intensity\nelement tristrips 1\n"
           "property list int int vertex_indices\n",
       [](MeshBytes& out) {
         for (int v = 0; v < 4; ++v) {
           put_position(out, v);
           out.put<std::uint8_t>(99);
         }
         out.put(11);
         for (const int v : {0, 1, 3, -1, 1, 2, 3, -1, 2, 0, 3}) out.put(v);
         return out.text;
       },
       false,
       false,
       false,
       false,
       {},
       true},
      {"CloudCompare, doubles and scalar fields",
       "format binary_little_endian 1.0\ncomment Created by CloudCompare v2.13.0 (Kharkiv)\n"
       "comment Created 1/1/24 12:00 PM\nobj_info Generated by CloudCompare!\n" +
           elements("property double x\nproperty double y\nproperty double z\n" + rgb8 +
                        "property float scalar_Original_cloud_index\n" + nxyz,
                    list),
       [](MeshBytes& out) {
         for (int v = 0; v < 4; ++v) {
           for (const float x : positions[v]) out.put<double>(x);
           for (const int c : colors[v]) out.put(static_cast<std::uint8_t>(c));
           out.put(17.0f);
           for (const float x : normals[v]) out.put(x);
         }
         put_faces(out);
         return out.text;
       },
       true, false, true},
      {"Open3D, doubles",
       "format ascii 1.0\ncomment Created by Open3D\n" +
           elements("property double x\nproperty double y\nproperty double z\n"
                    "property double nx\nproperty double ny\nproperty double nz\n" +
                        rgb8,
                    "property list uchar uint vertex_indices\n"),
       [](MeshBytes&) { return text_body([](int v) { return normal_text(v) + color_text(v); }); },
       true, false, true},
      {"PCL, with a camera before the faces",
       "format binary_little_endian 1.0\ncomment PCL generated\nelement vertex 4\n" + xyz + rgb8 +
           nxyz +
           "property float curvature\nelement camera 1\nproperty float view_px\n"
           "property float view_py\nproperty int viewportx\nelement face 3\n" +
           list,
       [](MeshBytes& out) {
         for (int v = 0; v < 4; ++v) {
           put_position(out, v);
           for (const int c : colors[v]) out.put(static_cast<std::uint8_t>(c));
           for (const float x : normals[v]) out.put(x);
           out.put(0.1f);
         }
         out.put(1.0f).put(2.0f).put(640);
         put_faces(out);
         return out.text;
       },
       true, false, true},
      {"assimp",
       "format binary_big_endian 1.0\ncomment Created by Open Asset Import Library - "
       "http://assimp.sf.net (v5.2)\n" +
           elements(xyz + nxyz +
                        "property float s\nproperty float t\n"
                        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                        "property uchar alpha\n",
                    "property list uchar int vertex_index\n"),
       [](MeshBytes& out) {
         for (int v = 0; v < 4; ++v) {
           put_position(out, v);
           for (const float x : normals[v]) out.put(x);
           out.put(uvs[v][0]).put(uvs[v][1]);
           for (const int c : colors[v]) out.put(static_cast<std::uint8_t>(c));
           out.put<std::uint8_t>(255);
         }
         put_faces(out);
         return out.text;
       },
       true,
       true,
       true,
       false,
       {},
       true},
      {"Metashape",
       "format ascii 1.0\ncomment Agisoft Metashape\n" +
           elements(xyz + "property uint8 red\nproperty uint8 green\nproperty uint8 blue\n"
                          "property uint8 class\n",
                    "property list uint8 int32 vertex_indices\n"),
       [](MeshBytes&) { return text_body([](int v) { return color_text(v) + " 2"; }); }, false,
       false, true},
      {"Rhino, with old names",
       "format ascii 1.0\ncomment Rhinoceros\n" +
           elements(xyz + nxyz +
                        "property float texture_s\nproperty float texture_t\n"
                        "property uchar ambient_red\nproperty uchar ambient_green\n"
                        "property uchar ambient_blue\nproperty uchar diffuse_red\n"
                        "property uchar diffuse_green\nproperty uchar diffuse_blue\n",
                    "property list int int vertex_index\n"),
       [](MeshBytes&) {
         return text_body(
             [](int v) { return normal_text(v) + uv_text(v) + " 9 9 9" + color_text(v); });
       },
       true, true, true},
      {"Artec, with colours of faces and windows' line ends",
       "format ascii 1.0\r\ncomment Artec Studio\r\nelement vertex 4\r\nproperty float x\r\n"
       "property float y\r\nproperty float z\r\nelement face 3\r\n"
       "property list uchar uint vertex_indices\r\nproperty uchar red\r\nproperty uchar green\r\n"
       "property uchar blue\r\n",
       [](MeshBytes&) { return text_body([](int) { return std::string("\r"); }, color_text); },
       false, false, false, true},
  };
}

std::vector<Color> linear_colors(int count) {
  std::vector<Color> result;
  for (int i = 0; i < count; ++i) {
    result.emplace_back(from_srgb(colors[i][0] / 255.0), from_srgb(colors[i][1] / 255.0),
                        from_srgb(colors[i][2] / 255.0));
  }
  return result;
}

void expect_colors(const std::vector<Color>& found, const std::vector<Color>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_LT(glm::length(found[i] - expected[i]), 1e-6f) << i;
  }
}

TEST(PlyExporters, AreReadAsTheyMeanIt) {
  for (const Exporter& exporter : exporters()) {
    SCOPED_TRACE(exporter.program);
    MeshBytes body(exporter.big_endian);
    const std::string file = "ply\n" + exporter.header + "end_header\n" + exporter.body(body);
    std::vector<std::string> warnings;
    MeshFileOptions options;
    options.warnings = &warnings;
    const Mesh mesh = decode_ply(file, "a.ply", options);
    EXPECT_EQ(warnings, exporter.warnings);
    ASSERT_EQ(mesh.positions.size(), 4u);
    ASSERT_EQ(mesh.triangles.size(), 3u);
    ASSERT_EQ(mesh.normals.size(), exporter.has_normals ? 4u : 0u);
    ASSERT_EQ(mesh.uvs.size(), exporter.has_uvs ? 4u : 0u);
    for (int v = 0; v < 4; ++v) {
      const Vec3 normal(normals[v][0], normals[v][1], normals[v][2]);
      EXPECT_EQ(mesh.positions[v], Vec3(positions[v][0], positions[v][1], positions[v][2]));
      if (exporter.has_normals) {
        EXPECT_LT(glm::length(mesh.normals[v] - normal), 1e-6f);
      }
      if (exporter.has_uvs) {
        EXPECT_EQ(mesh.uvs[v], Vec2(uvs[v][0], uvs[v][1]));
      }
    }
    for (int f = 0; f < 3; ++f) {
      for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(mesh.triangles[f].v[k], static_cast<std::uint32_t>(faces[f][k]));
      }
    }
    expect_colors(mesh.colors, exporter.has_colors ? linear_colors(4) : std::vector<Color>());
    expect_colors(mesh.face_colors,
                  exporter.has_face_colors ? linear_colors(3) : std::vector<Color>());
  }
}

TEST(PlyColors, OfAnyType) {
  struct Case {
    const char* type;
    std::vector<double> values;  ///< of three vertices, grey
    std::vector<float> expected;
  };
  const float half = from_srgb(128 / 255.0), low = from_srgb(1 / 255.0);
  const Case cases[] = {
      {"uchar", {255, 128, 1}, {1, half, low}},
      {"uchar", {1, 1, 0}, {low, low, 0}},
      {"char", {127, 0, -1}, {1, 0, 0}},
      {"short", {255, 128, 1}, {1, half, low}},
      {"short", {32767, 128, 0}, {1, from_srgb(128 / 32767.0), 0}},
      {"ushort", {65535, 32896, 257}, {1, half, low}},
      {"ushort", {256, 0, 0}, {from_srgb(256 / 65535.0), 0, 0}},
      {"int", {255, 128, 1}, {1, half, low}},
      {"int", {128, 128, -5}, {half, half, 0}},
      {"int", {65535, 32896, 257}, {1, half, low}},
      {"int", {2147483647, 1077952576, 0}, {1, half, 0}},
      {"uint", {255, 128, 1}, {1, half, low}},
      {"uint", {65535, 32896, 257}, {1, half, low}},
      {"uint", {4294967295, 2155905152, 0}, {1, half, 0}},
      {"float", {1, 0.5, 0.001}, {1, 0.5f, 0.001f}},
      {"float", {2.5, -1, NAN}, {2.5f, 0, 0}},
      {"double", {1, 0.25, INFINITY}, {1, 0.25f, 0}},
  };
  for (const Case& c : cases) {
    for (const bool of_faces : {false, true}) {
      SCOPED_TRACE(testing::Message() << c.type << ' ' << c.values[0] << " of faces " << of_faces);
      const std::string rgb =
          fmt::format("property {0} red\nproperty {0} green\nproperty {0} blue\n", c.type);
      std::string file = "ply\nformat ascii 1.0\nelement vertex 3\n" + xyz;
      file += (of_faces ? "" : rgb) + "element face 3\n" + list + (of_faces ? rgb : "");
      file += "end_header\n";
      const auto value = [&](int i, bool there) {
        return there ? fmt::format(" {0} {0} {0}", c.values[static_cast<std::size_t>(i)]) : "";
      };
      for (int i = 0; i < 3; ++i) file += fmt::format("{} {} 0{}\n", i, i * i, value(i, !of_faces));
      for (int i = 0; i < 3; ++i) file += "3 0 1 2" + value(i, of_faces) + "\n";
      const Mesh mesh = decode_ply(file, "a.ply");
      const std::vector<Color>& found = of_faces ? mesh.face_colors : mesh.colors;
      ASSERT_EQ(found.size(), 3u);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(found[i].x, c.expected[i], 2e-6);
        EXPECT_EQ(found[i].y, found[i].x);
        EXPECT_EQ(found[i].z, found[i].x);
      }
    }
  }
}

}  // namespace
}  // namespace pt
