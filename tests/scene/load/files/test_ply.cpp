// PLY files of every kind that other programs write, and broken ones.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/scene/load/files/meshes/mesh_files.h"
#include "load/mesh_bytes.h"
#include "temp_folder.h"

namespace pt {
namespace {

class Ply : public testing::Test {
 protected:
  Mesh read(const std::string& bytes, const MeshFileOptions& options = {}) const {
    write_text(path_, bytes);
    return read_ply(path_, options);
  }

  void expect_error_of(const std::string& bytes, const std::string& part) const {
    write_text(path_, bytes);
    expect_error([&] { read_ply(path_); }, "cannot read " + path_);
    expect_error([&] { read_ply(path_); }, part);
  }

  const TempFolder folder_;
  const std::string path_ = folder_.file("a.ply");
};

void expect_triangles(const Mesh& mesh, const std::vector<std::vector<std::uint32_t>>& expected) {
  ASSERT_EQ(mesh.triangles.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    for (int k = 0; k < 3; ++k) EXPECT_EQ(mesh.triangles[i].v[k], expected[i][k]) << i;
  }
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

const std::string square =
    "ply\nformat ascii 1.0\ncomment made by hand\nobj_info nothing\nelement vertex 4\n"
    "property float x\nproperty float y\nproperty float z\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n1 1 0\n0 1 0.5\n4 0 1 2 3\n";

TEST_F(Ply, TextWithAQuad) {
  const Mesh mesh = read(square);
  ASSERT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.positions[3], Vec3(0, 1, 0.5f));
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_TRUE(mesh.uvs.empty());
  expect_triangles(mesh, {{0, 1, 2}, {0, 2, 3}});
}

TEST_F(Ply, TextWithOtherLineEndsAndSpaces) {
  for (const std::string end : {"\r\n", "\r", " \t\n\n"}) {
    const std::string text = "ply" + replaced(square.substr(3), "\n", end);
    // A line 'ply' is exactly that.
    const Mesh mesh = read(end[0] == ' ' ? "ply\n" + text.substr(6) : text);
    EXPECT_EQ(mesh.positions.size(), 4u);
    expect_triangles(mesh, {{0, 1, 2}, {0, 2, 3}});
  }
  expect_triangles(read(square.substr(0, square.size() - 1)), {{0, 1, 2}, {0, 2, 3}});
}

// A triangle and a pentagon (or two triangles), vertices in an order and with properties that
// nothing but the header tells; a list in the vertices if asked for; edges in between.
std::string odd_file(bool big_endian, bool list_in_vertices, bool pentagon) {
  MeshBytes body(big_endian);
  for (int i = 0; i < 6; ++i) {
    body.put<std::uint8_t>(200).put<double>(10 + i);  // red, y
    if (list_in_vertices) body.put<std::uint16_t>(2).put<std::int16_t>(-1).put<std::int16_t>(7);
    body.put<float>(0.25f * i).put<std::int16_t>(-i).put<float>(1 - 0.125f * i);  // s, x, t
    body.put<double>(0).put<float>(-3).put<float>(i == 5 ? 4 : 0);                // ny, nz, nx
    body.put<std::uint32_t>(1000u * i);                                           // z
  }
  body.put<std::int32_t>(3).put<std::int32_t>(4);  // an edge
  body.put<float>(0.5f).put<std::uint16_t>(3);
  for (const std::uint32_t v : {5u, 0u, 1u}) body.put<std::uint32_t>(v);
  body.put<std::uint8_t>(9).put<float>(0.5f).put<std::uint16_t>(pentagon ? 5 : 3);
  for (const std::uint32_t v : {1u, 2u, 3u}) body.put<std::uint32_t>(v);
  if (pentagon) body.put<std::uint32_t>(4).put<std::uint32_t>(5);
  body.put<std::uint8_t>(9);
  return fmt::format(
             "ply\nformat binary_{}_endian 1.0\nelement vertex 6\nproperty uchar red\n"
             "property double y\n{}property float s\nproperty short x\nproperty float t\n"
             "property float64 ny\nproperty float32 nz\nproperty float nx\nproperty uint z\n"
             "element edge 1\nproperty int vertex1\nproperty int vertex2\nelement face 2\n"
             "property float quality\nproperty list ushort uint vertex_index\n"
             "property uchar flags\nend_header\n",
             big_endian ? "big" : "little",
             list_in_vertices ? "property list uint16 int16 neighbours\n" : "") +
         body.text;
}

TEST_F(Ply, AnyPropertiesInAnyOrder) {
  for (int kind = 0; kind < 8; ++kind) {
    const bool pentagon = kind & 4;
    const Mesh mesh = read(odd_file(kind & 1, kind & 2, pentagon));
    ASSERT_EQ(mesh.positions.size(), 6u) << kind;
    ASSERT_EQ(mesh.normals.size(), 6u);
    ASSERT_EQ(mesh.uvs.size(), 6u);
    for (int i = 0; i < 6; ++i) {
      const auto f = static_cast<float>(i);
      EXPECT_EQ(mesh.positions[i], Vec3(-f, 10 + f, 1000 * f));
      EXPECT_EQ(mesh.uvs[i], Vec2(0.25f * f, 1 - 0.125f * f));
      const Vec3 normal = i == 5 ? Vec3(0.8f, 0, -0.6f) : Vec3(0, 0, -1);
      EXPECT_LT(glm::length(mesh.normals[i] - normal), 1e-6f);
    }
    if (pentagon) {
      expect_triangles(mesh, {{5, 0, 1}, {1, 2, 3}, {1, 3, 4}, {1, 4, 5}});
    } else {
      expect_triangles(mesh, {{5, 0, 1}, {1, 2, 3}});
    }
  }
}

// mesh.write_ply() of Mitsuba 3.9.1 for two triangles with uvs and computed normals.
const std::string by_mitsuba(
    "ply\n"
    "format binary_little_endian 1.0\n"
    "element vertex 5\n"
    "property float x\n"
    "property float y\n"
    "property float z\n"
    "property float nx\n"
    "property float ny\n"
    "property float nz\n"
    "property float s\n"
    "property float t\n"
    "element face 2\n"
    "property list uchar int vertex_indices\n"
    "end_header\n"
    "\000\000\000\000\000\000\000\000\000\000\000\000\000\000\000\000\363\0045?\363\004"
    "5?\000\000\000\000\000\000@?\000\000\200?\000\000\000\000\000\000\000\000\000\000"
    "\000\000\000\000\000\000\000\000\200?\000\000\200?\000\000\200?\000\000\000\000\000"
    "\000\200?\000\000\000\000\000\000\000\000\000\000\000\000\000\000\200?\000\000\000"
    "\000\000\000\000\000\000\000\000\000\000\000\000\000\000\000\200?\000\000\000\000"
    "\000\000\200?\000\000\000\000\000\000\200?\000\000\200?\000\000\200?\000\000\000\000"
    "\000\000\000\000\000\000\000\000\000\000\200?\000\000\000\000\000\000\000\000\000"
    "\000\000\000\003\000\000\000\000\001\000\000\000\002\000\000\000\003\000\000\000\000"
    "\003\000\000\000\004\000\000\000",
    443);

TEST_F(Ply, WrittenByMitsuba) {
  const Mesh mesh = read(by_mitsuba);
  const std::vector<Vec3> positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
  EXPECT_EQ(mesh.positions, positions);
  const float h = std::sqrt(0.5f);
  const std::vector<Vec3> normals = {{0, h, h}, {0, 0, 1}, {0, 0, 1}, {0, 1, 0}, {0, 1, 0}};
  for (int i = 0; i < 5; ++i) EXPECT_LT(glm::length(mesh.normals[i] - normals[i]), 1e-6f) << i;
  const std::vector<Vec2> uvs = {{0, 0.75f}, {1, 1}, {0, 0}, {1, 1}, {0, 0}};
  EXPECT_EQ(mesh.uvs, uvs);
  expect_triangles(mesh, {{0, 1, 2}, {0, 3, 4}});
}

TEST_F(Ply, ComputedNormalsAreMitsubas) {
  Mesh mesh = read(by_mitsuba);
  const std::vector<Vec3> normals = mesh.normals;
  compute_vertex_normals(mesh);
  for (int i = 0; i < 5; ++i) EXPECT_LT(glm::length(mesh.normals[i] - normals[i]), 1e-6f) << i;
}

TEST_F(Ply, Options) {
  EXPECT_TRUE(read(by_mitsuba, {.face_normals = true}).normals.empty());
  EXPECT_EQ(read(by_mitsuba, {.flip_v = true}).uvs[0], Vec2(0, 0.25f));
}

TEST_F(Ply, NormalsWithoutDirectionAreReplaced) {
  std::string text = replaced(square, "property float z\n",
                              "property float z\nproperty float nx\nproperty float ny\n"
                              "property float nz\nproperty float u\nproperty float v\n");
  text = replaced(text, "0 0 0\n", "0 0 0 0 0 0 nan 0.5\n");
  text = replaced(text, "\n1 0 0\n", "\n1 0 0 nan 1 0 1 inf\n");
  text = replaced(text, "1 1 0\n", "1 1 0 3e38 3e38 0 1 1\n");
  text = replaced(text, "0 1 0.5\n", "0 1 0.5 0 1e-30 0 1 1\n");
  const Mesh mesh = read(text);
  ASSERT_EQ(mesh.normals.size(), 4u);
  EXPECT_EQ(mesh.normals[0], Vec3(0, 0, 1));
  EXPECT_EQ(mesh.normals[1], Vec3(0, 0, 1));
  EXPECT_NEAR(mesh.normals[2].x, std::sqrt(0.5f), 1e-6f);
  EXPECT_EQ(mesh.normals[3], Vec3(0, 1, 0));
  EXPECT_EQ(mesh.uvs[0], Vec2(0, 0.5f));
  EXPECT_EQ(mesh.uvs[1], Vec2(1, 0));
}

// Large enough for many blocks, each index of another value.
std::string large_file(std::uint32_t count, std::uint32_t bad_face) {
  MeshBytes body;
  for (std::uint32_t i = 0; i < count; ++i) {
    body.put(static_cast<float>(i)).put(static_cast<float>(i / 2)).put(1.0f);
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    body.put<std::uint8_t>(3).put(i).put((i + 1) % count).put(i == bad_face ? count : i / 3);
  }
  return fmt::format(
             "ply\nformat binary_little_endian 1.0\nelement vertex {0}\nproperty float x\n"
             "property float y\nproperty float z\nelement face {0}\n"
             "property list uchar int vertex_indices\nend_header\n",
             count) +
         body.text;
}

TEST_F(Ply, LargeFilesAreReadInParallel) {
  constexpr std::uint32_t count = 100'000;
  const Mesh mesh = read(large_file(count, count));
  ASSERT_EQ(mesh.triangles.size(), count);
  for (std::uint32_t i = 0; i < count; ++i) {
    ASSERT_EQ(mesh.positions[i], Vec3(i, i / 2, 1));
    ASSERT_EQ(mesh.triangles[i].v[0], i);
    ASSERT_EQ(mesh.triangles[i].v[1], (i + 1) % count);
    ASSERT_EQ(mesh.triangles[i].v[2], i / 3);
  }
  std::vector<std::string> warnings;
  MeshFileOptions options;
  options.warnings = &warnings;
  EXPECT_EQ(read(large_file(count, 70'001), options).triangles.size(), count - 1);
  EXPECT_EQ(warnings, std::vector<std::string>{"1 bad faces are left out, the first is face 70001: "
                                               "index 100000 into 100000 vertices"});
}

// Many faces of `corners[i % size]` vertices, in binary. Where all are alike they are read in
// parallel, else one after the other.
std::string polygons_file(const std::vector<std::uint32_t>& corners, std::uint32_t count,
                          bool big_endian) {
  MeshBytes body(big_endian);
  for (std::uint32_t i = 0; i < count; ++i) {
    body.put(static_cast<float>(i)).put(0.5f).put(-static_cast<float>(i));
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t n = corners[i % corners.size()];
    body.put<float>(0.25f).put(static_cast<std::uint8_t>(n));
    for (std::uint32_t k = 0; k < n; ++k) body.put<std::uint32_t>((i + k * k) % count);
    body.put<std::uint16_t>(77);
  }
  return fmt::format(
             "ply\nformat binary_{1}_endian 1.0\nelement vertex {0}\nproperty float x\n"
             "property float y\nproperty float z\nelement face {0}\nproperty float quality\n"
             "property list uchar uint vertex_indices\nproperty ushort flags\nend_header\n",
             count, big_endian ? "big" : "little") +
         body.text;
}

TEST_F(Ply, PolygonsAreFansWhetherReadInParallelOrInTurn) {
  constexpr std::uint32_t count = 20'000;
  const std::vector<std::vector<std::uint32_t>> kinds = {{3}, {4},          {5},   {6},
                                                         {9}, {3, 4, 5, 6}, {6, 3}};
  for (const std::vector<std::uint32_t>& corners : kinds) {
    for (const bool big_endian : {false, true}) {
      SCOPED_TRACE(testing::Message() << corners.size() << " kinds, first of " << corners[0]
                                      << ", big " << big_endian);
      const Mesh mesh = read(polygons_file(corners, count, big_endian));
      ASSERT_EQ(mesh.positions.size(), count);
      for (std::uint32_t i = 0; i < count; ++i)
        ASSERT_EQ(mesh.positions[i], Vec3(i, 0.5f, -1.0f * i));
      std::size_t triangle = 0;
      for (std::uint32_t i = 0; i < count; ++i) {
        for (std::uint32_t k = 2; k < corners[i % corners.size()]; ++k) {
          ASSERT_LT(triangle, mesh.triangles.size());
          const TriangleIndices& t = mesh.triangles[triangle++];
          ASSERT_EQ(t.v[0], i);
          ASSERT_EQ(t.v[1], (i + (k - 1) * (k - 1)) % count);
          ASSERT_EQ(t.v[2], (i + k * k) % count);
        }
      }
      ASSERT_EQ(triangle, mesh.triangles.size());
    }
  }
}

TEST_F(Ply, BrokenFilesAreRefusedWithTheirPlace) {
  expect_error([&] { read_ply(folder_.file("missing.ply")); }, "No such file");
  expect_error([&] { read_ply(folder_.file("")); }, "not a regular file");
  expect_error_of("", "not a PLY file");
  expect_error_of("plywood", "not a PLY file");
  expect_error_of("ply\nformat ascii 1.0\nelement vertex 4\n", "ends within its header");
  expect_error_of(replaced(square, "element vertex 4", "element vertex -4"), "line 5: '-4'");
  expect_error_of(replaced(square, "float y", "floor y"), "line 7: unknown type 'floor'");
  expect_error_of(replaced(square, "format ascii", "format utf8"), "line 2: unknown encoding");
  expect_error_of(replaced(square, "float y", "float w"), "without x, y and z");
  expect_error_of(replaced(square, "list uchar", "list float"), "count of a list is an integer");
  expect_error_of(
      replaced(square, "element face", "element faces"),
      "expected elements 'vertex' and 'face' or 'tristrips', found 4 vertex, 1 faces: points "
      "without faces are not supported");
  expect_error_of(replaced(square, "0 1 2 3\n", "0 1 2 4\n"), "face 0: index 4 into 4 vertices");
  expect_error_of(replaced(square, "0 1 2 3\n", "0 1 2 -1\n"), "face 0: index -1");
  expect_error_of(replaced(square, "4 0 1 2 3\n", "2 0 1\n"), "2 vertices, expected 3 or more");
  expect_error_of(replaced(square, "4 0 1 2 3\n", "-4 0 1\n"), "negative");
  expect_error_of(replaced(square, "4 0 1 2 3\n", "4 0 1 2\n"), "face 0: the file ends here");
  expect_error_of(replaced(square, "1 1 0\n", "1 x 0\n"),
                  "line 14: vertex 2: expected a number, found 'x'");
  expect_error_of(replaced(square, "4 0 1 2 3\n", "4 0 1 1.5 3\n"), "expected an integer");
  expect_error_of(replaced(square, "1 1 0\n", "1 nan 0\n"), "vertex 2: position");
  expect_error_of(replaced(square, "1 1 0\n", "1 1e39 0\n"), "vertex 2: position");
}

std::vector<std::string> warnings_of(const std::string& bytes, std::size_t triangles) {
  std::vector<std::string> warnings;
  MeshFileOptions options;
  options.warnings = &warnings;
  EXPECT_EQ(decode_ply(bytes, "a.ply", options).triangles.size(), triangles) << bytes;
  return warnings;
}

using Lines = std::vector<std::string>;

TEST_F(Ply, BadElementsLoseThemselves) {
  const std::string two = replaced(square, "face 1", "face 3");
  const auto with = [&](const std::string& face) {
    return replaced(two, "4 0 1 2 3\n", "4 0 1 2 3\n" + face + "\n3 0 1 3\n");
  };
  const std::string lost = "1 bad faces are left out, the first is face 1: ";
  EXPECT_EQ(warnings_of(with("3 0 1 2"), 4), Lines{});
  EXPECT_EQ(warnings_of(with("2 0 1"), 3), Lines{lost + "2 vertices, expected 3 or more"});
  EXPECT_EQ(warnings_of(with("0"), 3), Lines{lost + "0 vertices, expected 3 or more"});
  EXPECT_EQ(warnings_of(with("3 0 1 4"), 3), Lines{lost + "index 4 into 4 vertices"});
  EXPECT_EQ(warnings_of(with("5 0 -1 9 1 2"), 3), Lines{lost + "index -1 into 4 vertices"});
  // Vertex 2 is one of two triangles of four; were it one of three, the file would be damaged.
  const std::string nan = replaced(with("3 0 1 3"), "1 1 0\n", "1 nan 0\n");
  EXPECT_EQ(warnings_of(nan, 2), Lines{"2 bad triangles are left out, the first because of vertex "
                                       "2: position (1, nan, 0), expected finite numbers"});
  expect_error_of(replaced(with("3 0 1 2"), "1 1 0\n", "1 nan 0\n"), "vertex 2: position");
  // Nobody uses the vertex.
  EXPECT_EQ(
      warnings_of(
          replaced(replaced(with("3 0 1 3"), "1 1 0\n", "1 nan 0\n"), "4 0 1 2 3", "3 0 1 3"), 3),
      Lines{});
}

TEST_F(Ply, LostFacesTakeTheirColoursAlong) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement face 4\nproperty list uchar int vertex_indices\n"
      "property float red\nproperty float green\nproperty float blue\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\nnan 1 0\n3 0 1 2 0.1 0 0\n2 0 1 0.2 0 0\n3 0 1 3 0.3 0 0\n"
      "3 1 2 0 0.4 0 0\n";
  const Mesh mesh = read(text);
  expect_triangles(mesh, {{0, 1, 2}, {1, 2, 0}});
  EXPECT_EQ(mesh.face_colors, (std::vector<Color>{{0.1f, 0, 0}, {0.4f, 0, 0}}));
}

TEST_F(Ply, NormalsWithoutADirectionAndHalfOnesAreReported) {
  const std::string normals =
      replaced(square, "property float z\n",
               "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n");
  std::string text = replaced(normals, "0 0 0\n", "0 0 0 0 0 0\n");
  text = replaced(text, "\n1 0 0\n", "\n1 0 0 nan 1 0\n");
  text = replaced(text, "1 1 0\n", "1 1 0 0 0 2\n");
  text = replaced(text, "0 1 0.5\n", "0 1 0.5 0 0 1\n");
  EXPECT_EQ(warnings_of(text, 2), Lines{"2 of 4 vertices have no normal or one without a "
                                        "direction: that of a triangle is used"});
  const std::string half = replaced(text, "property float nz\n", "property float nw\n");
  EXPECT_EQ(warnings_of(half, 2), Lines{"2 of the 3 components of normals are there: these are "
                                        "ignored"});
}

std::string strip_file(const std::string& name, const std::string& lists, int count) {
  return fmt::format(
      "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
      "property float z\nelement {} {}\nproperty list int int {}\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n{}\n",
      name, count, "vertex_indices", lists);
}

TEST_F(Ply, StripsOfTriangles) {
  struct Case {
    const char* lists;
    int count;
    std::vector<std::vector<std::uint32_t>> triangles;
  };
  const Case cases[] = {
      {"6 0 1 2 3 4 5", 1, {{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {4, 3, 5}}},
      {"7 0 1 2 -1 2 3 4", 1, {{0, 1, 2}, {2, 3, 4}}},
      {"9 0 1 2 3 -1 2 3 4 5", 1, {{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {4, 3, 5}}},
      {"8 -1 -1 0 1 2 -1 4 -1", 1, {{0, 1, 2}}},
      {"3 0 1 2\n4 2 3 4 5", 2, {{0, 1, 2}, {2, 3, 4}, {4, 3, 5}}},
      {"8 0 1 2 2 3 3 4 5", 1, {{0, 1, 2}, {4, 3, 5}}},  // joined by triangles without an area
      {"0\n2 0 1\n3 3 4 5", 3, {{3, 4, 5}}},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.lists);
    expect_triangles(read(strip_file("tristrips", c.lists, c.count)), c.triangles);
  }
  EXPECT_EQ(warnings_of(strip_file("tristrips", "8 0 1 2 9 2 3 4 5", 1), 3),
            Lines{"1 bad faces are left out, the first is face 0: index 9 into 6 vertices"});
  expect_error_of(strip_file("tristrips", "7 0 1 2 -1 2 3", 1), "strip 0: the file ends here");
  expect_error_of(strip_file("points", "1 0", 1), "found 6 vertex, 1 points: points without faces");
}

TEST_F(Ply, StripsInBinaryBesideFaces) {
  for (const bool big_endian : {false, true}) {
    MeshBytes body(big_endian);
    for (int i = 0; i < 5; ++i) body.put(static_cast<float>(i)).put(0.0f).put(1.0f);
    body.put<std::int32_t>(5);
    for (const int v : {0, 1, 2, -1, 4}) body.put<std::int32_t>(v);
    for (const int v : {4, 0, 2, 3, 4}) body.put(static_cast<std::uint8_t>(v));
    const Mesh mesh =
        read(fmt::format("ply\nformat binary_{}_endian 1.0\nelement vertex 5\nproperty float x\n"
                         "property float y\nproperty float z\nelement tristrips 1\n"
                         "property list int int vertex_indices\nelement face 1\n"
                         "property list uchar uchar vertex_indices\nend_header\n",
                         big_endian ? "big" : "little") +
             body.text);
    expect_triangles(mesh, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}});
  }
}

TEST_F(Ply, ManyElementsAndPropertiesTakeNoTime) {
  std::string text = "ply\nformat ascii 1.0\n";
  for (int i = 0; i < 100'000; ++i) text += fmt::format("element e{} 0\nproperty int x\n", i);
  text += square.substr(square.find("element vertex"));
  EXPECT_EQ(read(text).triangles.size(), 2u);
  std::string properties, values;
  for (int i = 0; i < 100'000; ++i) {
    properties += fmt::format("property uchar p{}\n", i);
    values += " 0";
  }
  text = replaced(square, "property float z\n", "property float z\n" + properties);
  for (const std::string vertex : {"\n0 0 0", "\n1 0 0", "\n1 1 0", "\n0 1 0.5"}) {
    text = replaced(text, vertex + "\n", vertex + values + "\n");
  }
  EXPECT_EQ(read(text).positions[3], Vec3(0, 1, 0.5f));
}

TEST_F(Ply, MessagesQuoteLittleOfTheFile) {
  const std::string long_word(1'000'000, 'x');
  for (const char* word : {"ascii", "vertex", "4", "float", "property", "vertex_indices", "face"}) {
    try {
      decode_ply(replaced(square, word, long_word), "a.ply");
    } catch (const Error& error) {
      EXPECT_LT(std::string(error.what()).size(), 400u) << word;
    }
  }
}

TEST_F(Ply, ErrorsAreOneLineWhateverTheFileSays) {
  // Found by fuzzing: where lines end with \r, a \n may stand in a word.
  expect_error_of("ply\rformat as\ncii 1.0\rend_header\r", "unknown encoding 'as?cii'");
}

TEST_F(Ply, AnnouncedCountsAreCheckedBeforeMemoryIsTaken) {
  for (const std::string count : {"1000000000000", "4000000000", "18446744073709551615"}) {
    expect_error_of(replaced(square, "vertex 4", "vertex " + count), "cannot hold");
    expect_error_of(replaced(square, "face 1", "face " + count), "cannot hold");
    std::string binary = odd_file(false, true, false);
    expect_error_of(replaced(binary, "vertex 6", "vertex " + count), "cannot hold");
    expect_error_of(replaced(binary, "face 2", "face " + count), "cannot hold");
    expect_error_of(replaced(binary, "edge 1", "edge " + count), "cannot hold");
  }
  expect_error_of(replaced(square, "4 0 1 2 3\n", "4000000000 0 1 2 3\n"), "the file ends here");
}

TEST_F(Ply, EveryTruncationIsRefused) {
  for (int kind = 0; kind < 8; ++kind) {
    const std::string bytes = odd_file(kind & 1, kind & 2, kind & 4);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      expect_error([&] { decode_ply(bytes.substr(0, size), "a.ply"); }, "");
    }
  }
}

}  // namespace
}  // namespace pt
