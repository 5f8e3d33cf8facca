// OBJ and MTL files.
#include <gtest/gtest.h>

#include <cmath>

#include "common/scene/load/files/meshes/mesh_files.h"
#include "temp_folder.h"

namespace pt {
namespace {

// Two triangles that share an edge whose corners differ in their texture vertices.
const std::string two_triangles =
    "# a comment\n"
    "v 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0 1.0\nv 0 0 1\n"
    "vt 0 0.25\nvt 1\nvt 0 1 0\nvn 0 0 2\n"
    "o object\ng group\ns off\n"
    "f 1/1/1 2/2/1 3/3/1\nf 1/1/1 -1/-2/-1 2/3/1\n";

TEST(Obj, EqualCornersShareAVertex) {
  const Mesh mesh = decode_obj(two_triangles, "a.obj");
  const std::vector<Vec3> positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
  EXPECT_EQ(mesh.positions, positions);
  const std::vector<Vec2> uvs = {{0, 0.25f}, {1, 0}, {0, 1}, {1, 0}, {0, 1}};
  EXPECT_EQ(mesh.uvs, uvs);
  EXPECT_EQ(mesh.normals, std::vector<Vec3>(5, Vec3(0, 0, 1)));
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.triangles[1].v[0], 0u);
  EXPECT_EQ(mesh.triangles[1].v[1], 3u);
  EXPECT_EQ(mesh.triangles[1].v[2], 4u);
}

TEST(Obj, LinesMayEndAsTheyLikeAndGoOn) {
  const Mesh expected = decode_obj(two_triangles, "a.obj");
  for (const std::string end : {"\r\n", "\r", "\n\n", " \t\n"}) {
    std::string text;
    for (const char c : two_triangles) text += c == '\n' ? end : std::string(1, c);
    const Mesh mesh = decode_obj(text, "a.obj");
    EXPECT_EQ(mesh.positions, expected.positions);
    EXPECT_EQ(mesh.triangles.size(), 2u);
  }
  EXPECT_EQ(decode_obj("v 0 0 0\nv 1 \\\n0 0\nv 0 1 0\nf 1 2 \\\r\n 3", "a.obj").triangles.size(),
            1u);
}

TEST(Obj, PolygonsBecomeFans) {
  const Mesh mesh =
      decode_obj("v 0 0 0\nv 2 0 0\nv 3 1 0\nv 1 3 0\nv 0 1 0\nf 1 2 3 4 5 # pentagon\n", "a.obj");
  ASSERT_EQ(mesh.triangles.size(), 3u);
  for (std::uint32_t i = 0; i < 3; ++i) {
    EXPECT_EQ(mesh.triangles[i].v[0], 0u);
    EXPECT_EQ(mesh.triangles[i].v[1], i + 1);
    EXPECT_EQ(mesh.triangles[i].v[2], i + 2);
  }
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_TRUE(mesh.uvs.empty());
}

TEST(Obj, CornersWithoutANormalGetTheTriangles) {
  const Mesh mesh = decode_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 1 0 0\nf 1//1 2 3\n", "a.obj");
  ASSERT_EQ(mesh.normals.size(), 3u);
  EXPECT_EQ(mesh.normals[0], Vec3(1, 0, 0));
  EXPECT_EQ(mesh.normals[1], Vec3(0, 0, 1));
}

TEST(Obj, Options) {
  EXPECT_TRUE(decode_obj(two_triangles, "a.obj", {.face_normals = true}).normals.empty());
  EXPECT_EQ(decode_obj(two_triangles, "a.obj", {.flip_v = true}).uvs[0], Vec2(0, 0.75f));
}

struct BadLine {
  std::string text;  ///< behind three points, and before a face of them
  std::string warning;
  std::size_t triangles = 1;
};

// What is wrong is left out, and the file is read.
TEST(Obj, ABadLineLosesItself) {
  const std::vector<BadLine> cases = {
      {"v 1 2", "line 4: expected a number, found '': faces that use the vertex are left out"},
      {"v 1 x 1", "line 4: expected a number, found 'x'"},
      {"\r\nv 1 nan 1\r", "line 5: position (1, nan, 1), expected finite numbers"},
      {"v 1 2e38 -4e38", "line 4: position"},
      {"v 1 x 1\nf 1 2 4", "line 4: expected a number"},
      {"v 1 2 3 1 x 1", "line 4: expected a number, found 'x': the vertex is white"},
      {"vt x", "line 4: expected a number, found 'x': it is (0, 0)"},
      {"vn 0 0", "line 4: expected a number, found '': that of the triangle is used"},
      {"f 1 2", "line 4: a face with 2 vertices, expected 3 or more: the face is left out"},
      {"f", "line 4: a face with 0 vertices"},
      {"f 1 2 4", "line 4: vertex 4, of 3 so far: the face is left out"},
      {"f 1 2 -4", "line 4: vertex -4, of 3 so far"},
      {"f 1 2 0", "line 4: vertex 0, of 3 so far"},
      {"f 1 2 99999999999999999999", "line 4: vertex 99999999999999999999, of 3 so far"},
      {"f 1 2 x", "line 4: expected the number of a vertex, found 'x'"},
      {"f 1 2 3/\\\n///4", "line 5: "},
      {"f 1//1/1 2 3", "line 4: a corner with more than three indices"},
      {"f 1/1 2/1 3/1", "line 4: texture vertex 1, of 0 so far: the corner has no texture", 2},
      {"f 1//1 2//1 3//1", "line 4: normal 1, of 0 so far: the corner has the normal of its", 2},
      {"f 1/x 2 3", "line 4: expected the number of a texture vertex, found 'x'", 2},
      {"f -3 -2 -1", "", 2},
      {"surf 0 1 0 1 1 2 3 4", "line 4: free-form curves and surfaces are left out"},
      {"l 1 2\np 1\ng\no x\ns off\ncall x\n# f 9 9 9", ""},
  };
  for (const BadLine& c : cases) {
    std::vector<std::string> warnings;
    MeshFileOptions options;
    options.warnings = &warnings;
    const Mesh mesh =
        decode_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + c.text + "\nf 1 2 3\n", "a.obj", options);
    EXPECT_EQ(mesh.triangles.size(), c.triangles) << c.text;
    const std::size_t kinds = c.text.find("\nf 1 2 4") != std::string::npos ? 2 : 1;
    EXPECT_EQ(warnings.size(), c.warning.empty() ? 0u : kinds) << c.text;
    if (!warnings.empty()) {
      EXPECT_NE(warnings[0].find(c.warning), std::string::npos) << warnings[0];
    }
    for (const Vec3& p : mesh.positions) EXPECT_TRUE(std::isfinite(p.x)) << c.text;
  }
  const TempFolder folder;
  expect_error([&] { read_obj(folder.file("missing.obj")); }, "missing.obj: No such file");
}

TEST(Obj, VerticesBetweenColouredOnesAreWhite) {
  const Mesh mesh = decode_obj("v 0 0 0\nv 1 0 0 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj");
  EXPECT_EQ(mesh.colors, (std::vector<Color>{Color(1), Color(1, 0, 0), Color(1)}));
}

// Also where the first corners come before all that has a colour.
TEST(Obj, VerticesBeforeColouredOnesAreWhite) {
  const Mesh mesh = decode_obj("v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nf 2 3 1\n", "a.obj");
  EXPECT_EQ(mesh.positions, (std::vector<Vec3>{{1, 0, 0}, {0, 1, 0}, {0, 0, 0}}));
  EXPECT_EQ(mesh.colors, (std::vector<Color>{Color(1), Color(1), Color(1, 0, 0)}));
}

// What a double cannot hold is 0 or infinite, which is no position.
TEST(Obj, NumbersBeyondADouble) {
  std::vector<std::string> warnings;
  MeshFileOptions options;
  options.warnings = &warnings;
  const std::string rest = "v 1 0 0\nv 0 1 0\nv 1 1 0\nf 2 4 3\nf 1 2 3\n";
  for (const char* tiny : {"1e-400", "-1e-999", "1E-400", "0.1e-310"}) {
    const Mesh mesh = decode_obj(std::string("v 0 ") + tiny + " 0\n" + rest, "a.obj", options);
    EXPECT_EQ(mesh.triangles.size(), 2u) << tiny;
    EXPECT_TRUE(warnings.empty()) << tiny;
  }
  for (const char* huge : {"1e400", "-1e999", "1e39"}) {
    const Mesh mesh = decode_obj(std::string("v 0 ") + huge + " 0\n" + rest, "a.obj", options);
    EXPECT_EQ(mesh.triangles.size(), 1u) << huge;
    EXPECT_EQ(warnings.size(), 2u) << huge;  // the vertex, and its face
    warnings.clear();
  }
}

TEST(Obj, BadLinesAreCounted) {
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  for (int i = 0; i < 1000; ++i) text += "f 1 2\nf 1 2 9\nf 1//7 2 3\n";
  std::vector<std::string> warnings;
  MeshFileOptions options;
  options.warnings = &warnings;
  EXPECT_EQ(decode_obj(text, "a.obj", options).triangles.size(), 1001u);
  ASSERT_EQ(warnings.size(), 3u);
  for (const std::string& warning : warnings) {
    EXPECT_TRUE(warning.ends_with(" (and 999 more)")) << warning;
  }
}

}  // namespace
}  // namespace pt
