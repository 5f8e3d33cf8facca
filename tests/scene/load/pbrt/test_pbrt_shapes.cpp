// pbrt's shapes.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "common/scene/load/pbrt/scene_parts.h"
#include "load/expect_near.h"
#include "load/pbrt_scene.h"

namespace pt {
namespace {

const std::string checks =
    "Texture \"t\" \"spectrum\" \"checkerboard\"\nMaterial \"diffuse\" \"texture reflectance\" "
    "\"t\"\n";

Mesh only_mesh(const std::string& text) {
  const SceneData scene = load_pbrt_silently(pbrt_world(lit + text));
  EXPECT_EQ(scene.meshes.size(), 1u);
  return scene.meshes.at(0);
}

/// The position where a mesh has these texture coordinates at a vertex.
Vec3 at_uv(const Mesh& mesh, float u, float v) {
  for (std::size_t i = 0; i < mesh.uvs.size(); ++i) {
    if (glm::length(mesh.uvs[i] - Vec2(u, v)) < 1e-5f) return mesh.positions[i];
  }
  ADD_FAILURE() << "no vertex at " << u << ", " << v;
  return {};
}

TEST(PbrtShapes, TransformationsApplyToWhatFollowsThem) {
  // First scaled, then turned about z from x to y, then moved.
  const SceneData scene = load_pbrt_silently(pbrt_world(
      lit + "Translate 1 2 3 Rotate 90 0 0 1 Scale 2 2 2 Translate 5 0 0 Shape \"sphere\""));
  expect_near(scene.spheres.at(0).center, {1, 12, 3});
  EXPECT_FLOAT_EQ(scene.spheres[0].radius(), 2.0f);
}

TEST(PbrtShapes, CutSpheresHavePbrtsCoordinates) {
  const Mesh mesh = only_mesh(checks +
                              "Shape \"sphere\" \"float radius\" 2 \"float zmin\" -1 "
                              "\"float phimax\" 180");
  expect_near(at_uv(mesh, 0, 0), {std::sqrt(3.0f), 0, -1});
  expect_near(at_uv(mesh, 1, 0), {-std::sqrt(3.0f), 0, -1});
  expect_near(at_uv(mesh, 0.5f, 1), {0, 0, 2});
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    expect_near(mesh.normals[i], 0.5f * mesh.positions[i]);
  }
}

TEST(PbrtShapes, DisksAndCylinders) {
  const Mesh disk = only_mesh(checks +
                              "Shape \"disk\" \"float radius\" 2 \"float innerradius\" 1 "
                              "\"float height\" 3");
  expect_near(at_uv(disk, 0, 0), {2, 0, 3});
  expect_near(at_uv(disk, 0.25f, 1), {0, 1, 3});
  const Mesh cylinder = only_mesh(checks +
                                  "Shape \"cylinder\" \"float radius\" 2 \"float zmin\" 0 "
                                  "\"float zmax\" 5");
  expect_near(at_uv(cylinder, 0.25f, 0), {0, 2, 0});
  expect_near(at_uv(cylinder, 0, 1), {2, 0, 5});
}

TEST(PbrtShapes, ReverseOrientationTurnsNormalsAndWinding) {
  for (const bool reverse : {false, true}) {
    const Mesh mesh =
        only_mesh(std::string(reverse ? "ReverseOrientation " : "") + "Shape \"cylinder\"");
    const float sign = reverse ? -1.0f : 1.0f;
    for (const TriangleIndices& t : mesh.triangles) {
      const Vec3& p = mesh.positions[t.v[0]];
      const Vec3 n = glm::cross(mesh.positions[t.v[1]] - p, mesh.positions[t.v[2]] - p);
      EXPECT_GT(sign * dot(n, Vec3(p.x, p.y, 0)), 0.0f);
      EXPECT_GT(sign * dot(mesh.normals[t.v[0]], Vec3(p.x, p.y, 0)), 0.0f);
    }
  }
}

TEST(PbrtShapes, TrianglesWithoutCoordinatesHavePbrts) {
  const Mesh mesh = only_mesh(checks +
                              "Shape \"trianglemesh\" \"integer indices\" [0 1 2 2 1 3] "
                              "\"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]");
  ASSERT_EQ(mesh.uvs.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    const Vec2 expected[] = {{0, 0}, {1, 0}, {1, 1}};
    EXPECT_EQ(mesh.uvs[i], expected[i % 3]);
  }
}

TEST(PbrtShapes, BilinearPatchesAreCurvedWhereTheirCornersAreNotFlat) {
  const Mesh flat = only_mesh("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]");
  EXPECT_EQ(flat.triangles.size(), 2u);
  expect_near(flat.normals[0], {0, 0, 1});
  const Mesh saddle =
      only_mesh(checks +
                "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1] \"point2 uv\" "
                "[0 0 2 0 0 2 2 2]");
  expect_near(at_uv(saddle, 1, 1), {0.5f, 0.5f, 0.25f});
  // z = x y there.
  for (const Vec3& p : saddle.positions) EXPECT_NEAR(p.z, p.x * p.y, 1e-5f);
}

TEST(PbrtShapes, PlyFilesAlsoCompressed) {
  const TempFolder folder;
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  const gzFile file = gzopen(folder.file("a.ply.gz").c_str(), "wb");
  gzwrite(file, ply.data(), static_cast<unsigned>(ply.size()));
  gzclose(file);
  write_text(folder.file("a.ply"), ply);
  for (const char* name : {"a.ply", "a.ply.gz"}) {
    write_text(
        folder.file("scene.pbrt"),
        pbrt_world(lit + "Translate 0 0 7 Shape \"plymesh\" \"string filename\" \"" + name + "\""));
    const SceneData scene = load_pbrt_file(folder.file("scene.pbrt")).scene;
    ASSERT_EQ(scene.meshes.size(), 1u);
    expect_near(scene.meshes[0].positions[1], {1, 0, 7});
    EXPECT_TRUE(scene.meshes[0].normals.empty());  // pbrt's are flat
  }
}

const std::string bend = "\"point3 P\" [0 0 0  1 0 0  1 1 0  1 1 1] ";

TEST(PbrtShapes, CurvesAreTubesAsWideAsTheySay) {
  const Mesh mesh = only_mesh(checks +
                              "Shape \"curve\" \"string type\" \"cylinder\" \"float width0\" .2 "
                              "\"float width1\" .1 " +
                              bend);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    // Bernstein's polynomials.
    const float t = mesh.uvs[i].x, s = 1 - t;
    const Vec3 on_curve =
        3 * s * s * t * Vec3(1, 0, 0) + 3 * s * t * t * Vec3(1, 1, 0) + t * t * t * Vec3(1, 1, 1);
    const Vec3 along = s * s * Vec3(1, 0, 0) + 2 * s * t * Vec3(0, 1, 0) + t * t * Vec3(0, 0, 1);
    const Vec3 aside = mesh.positions[i] - on_curve;
    // The octagon whose circumference is the circle's.
    EXPECT_NEAR(glm::length(aside), 0.5f * (0.2f * s + 0.1f * t) * 1.0262f, 1e-4f);
    EXPECT_NEAR(glm::dot(glm::normalize(aside), glm::normalize(along)), 0.0f, 1e-3f);
    expect_near(glm::normalize(aside), mesh.normals[i], 1e-4f);
  }
  EXPECT_EQ(mesh.triangles.size(), 2u * 4 * 8);
}

TEST(PbrtShapes, CurvesOfAllBasesArePbrts) {
  // Quadratic and cubic, of Bezier and of B-splines: de Boor's values at the knots.
  const auto ends = [](const std::string& parameters) {
    const Mesh mesh = only_mesh(checks +
                                "Shape \"curve\" \"string type\" \"cylinder\" "
                                "\"float width\" 1e-4 " +
                                parameters);
    return std::pair(at_uv(mesh, 0, 0), at_uv(mesh, 1, 0));
  };
  const std::string points = "\"point3 P\" [0 0 0  6 0 0  6 6 0  6 6 6  0 6 6] ";
  const auto [a, b] = ends("\"integer degree\" 2 " + points);
  expect_near(a, {0, 0, 0}, 1e-3f), expect_near(b, {6, 6, 0}, 1e-3f);
  const auto [c, d] = ends("\"string basis\" \"bspline\" \"integer degree\" 2 " + points);
  expect_near(c, {3, 0, 0}, 1e-3f), expect_near(d, {6, 3, 0}, 1e-3f);
  const auto [e, f] = ends("\"string basis\" \"bspline\" " + points);
  expect_near(e, {5, 1, 0}, 1e-3f), expect_near(f, {6, 5, 1}, 1e-3f);
  EXPECT_NE(
      pbrt_complaint(pbrt_world("Shape \"curve\" " + points)).find("5 points in 'P'; expected"),
      std::string::npos);
}

TEST(PbrtShapes, RibbonsLieAcrossTheirNormals) {
  const Mesh mesh = only_mesh(checks +
                              "Shape \"curve\" \"string type\" \"ribbon\" \"float width\" .4 "
                              "\"normal N\" [0 0 1  0 1 0] "
                              "\"point3 P\" [0 0 0  1 0 0  2 0 0  3 0 0]");
  EXPECT_NEAR(std::abs(at_uv(mesh, 0, 0).y), 0.2f, 1e-5f);
  EXPECT_NEAR(std::abs(at_uv(mesh, 1, 1).z), 0.2f, 1e-5f);
  const Vec3 middle = at_uv(mesh, 0.5f, 1) - at_uv(mesh, 0.5f, 0);
  EXPECT_NEAR(std::abs(middle.y), 0.4f * std::sqrt(0.5f), 1e-5f);
  EXPECT_EQ(mesh.triangles.size(), 2u * 4);
  const std::string flat = pbrt_world(lit + "Shape \"curve\" " + bend);
  EXPECT_EQ(load_pbrt_text(flat).count("a tube is used"), 1);
}

TEST(PbrtShapes, MappingsOfTexturesByPoints) {
  const auto mapped = [](const std::string& mapping, const std::string& shape) {
    return only_mesh(
        "Translate 1 0 0 Scale 2 2 2\nTexture \"t\" \"spectrum\" \"checkerboard\" "
        "\"string mapping\" " +
        mapping +
        "\nMaterial \"diffuse\" \"texture "
        "reflectance\" \"t\" Translate 3 0 0 " +
        shape);
  };
  const std::string disk = "Shape \"disk\" \"float height\" 1";
  // In the texture's space, where the disk is moved by 3 along x.
  const Mesh plane = mapped(
      "\"planar\" \"vector3 v1\" [0 2 0] \"vector3 v2\" [1 0 0] \"float "
      "udelta\" .5",
      disk);
  const Mesh ball = mapped("\"spherical\"", disk), tube = mapped("\"cylindrical\"", disk);
  const auto own = [](const Vec3& world) { return (world - Vec3(1, 0, 0)) / 2.0f; };
  for (std::size_t i = 0; i < plane.positions.size(); ++i) {
    const Vec3 p = own(plane.positions[i]);
    EXPECT_NEAR(plane.uvs[i].x, 0.5f + 2 * p.y, 1e-5f);
    EXPECT_NEAR(plane.uvs[i].y, p.x, 1e-5f);
  }
  for (std::size_t i = 0; i < ball.positions.size(); ++i) {
    const Vec3 p = own(ball.positions[i]);
    EXPECT_NEAR(std::cos(ball.uvs[i].x * pi), 1 / glm::length(p), 1e-4f);
    EXPECT_NEAR(std::tan(ball.uvs[i].y * 2 * pi), p.y / p.x, 1e-4f);
    EXPECT_NEAR(tube.uvs[i].y, 1.0f, 1e-5f);
    EXPECT_NEAR(std::tan(tube.uvs[i].x * 2 * pi), p.y / p.x, 1e-4f);
  }
}

TEST(PbrtShapes, TrianglesAcrossASeamAreNotTurnedAround) {
  const Mesh mesh = only_mesh(
      "Texture \"t\" \"spectrum\" \"checkerboard\" \"string mapping\" \"cylindrical\"\n"
      "Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\" \"float zmax\" .99");
  for (const TriangleIndices& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const float step = mesh.uvs[t.v[i]].x - mesh.uvs[t.v[(i + 1) % 3]].x;
      EXPECT_LT(std::abs(step), 0.01f);
    }
  }
}

TEST(PbrtShapes, OneSurfaceHasOneMapping) {
  const auto texture = [](const char* name, const char* mapping) {
    return fmt::format("Texture \"{}\" \"spectrum\" \"checkerboard\" \"string mapping\" \"{}\"\n",
                       name, mapping);
  };
  const std::string text =
      texture("a", "planar") + texture("b", "uv") +
      "MakeNamedMaterial \"x\" \"string type\" \"diffuse\" \"texture "
      "reflectance\" \"a\" MakeNamedMaterial \"y\" \"string type\" \"diffuse\" "
      "\"texture reflectance\" \"b\"\n";
  const auto warnings = [&](const std::string& material) {
    return load_pbrt_text(pbrt_world(lit + text + material + " Shape \"disk\""))
        .count("textures of different mappings on one surface");
  };
  EXPECT_EQ(warnings("Material \"mix\" \"string materials\" [ \"x\" \"y\" ]"), 1);
  EXPECT_EQ(warnings("Material \"mix\" \"string materials\" [ \"x\" \"x\" ]"), 0);
  EXPECT_EQ(warnings("NamedMaterial \"y\" Shape \"disk\" NamedMaterial \"x\""), 0);
}

TEST(PbrtShapes, ObjectsAreInstanced) {
  const SceneData scene = load_pbrt_silently(pbrt_world(
      lit +
      "ObjectBegin \"a\" Translate 1 0 0 Shape \"sphere\" Shape \"disk\" ObjectEnd\n"
      "Shape \"sphere\" Scale 2 2 2 ObjectInstance \"a\" Translate 0 3 0 ObjectInstance \"a\""));
  EXPECT_EQ(scene.spheres.size(), 1u);
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[0].group, 1u);
  ASSERT_EQ(scene.instances.size(), 2u);
  expect_near(scene.instances[1].to_world.point({1, 0, 0}), {2, 6, 0});
}

TEST(PbrtShapes, AlphaIsOpacity) {
  const SceneData scene = load_pbrt_silently(
      pbrt_world(lit + "Shape \"disk\" \"float alpha\" .25\nTexture \"a\" \"float\" "
                       "\"checkerboard\" Shape \"disk\" \"texture alpha\" \"a\""));
  EXPECT_FLOAT_EQ(scene.materials[scene.meshes.at(0).material].opacity.offset, 0.25f);
  const Opacity& textured = scene.materials[scene.meshes.at(1).material].opacity;
  EXPECT_NE(textured.texture, no_texture);
  EXPECT_EQ(textured.cutoff, 0.0f);  // a probability; all or nothing in pbrt-v3 alone
  EXPECT_FALSE(scene.meshes[1].uvs.empty());
}

// ---- Loop's subdivision

using pbrt::subdivide_loop;

Mesh cage(const std::vector<Vec3>& positions, const std::vector<TriangleIndices>& triangles) {
  Mesh mesh;
  mesh.positions = positions, mesh.triangles = triangles;
  return mesh;
}

Mesh octahedron() {
  return cage({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}, {{{0, 2, 4}},
                                                                                      {{2, 1, 4}},
                                                                                      {{1, 3, 4}},
                                                                                      {{3, 0, 4}},
                                                                                      {{2, 0, 5}},
                                                                                      {{1, 2, 5}},
                                                                                      {{3, 1, 5}},
                                                                                      {{0, 3, 5}}});
}

/// A bent strip: its border has corners of one triangle, of two and of three.
Mesh bent_sheet() {
  return cage({{0, 0, 0},
               {1, 0, 0.5f},
               {2, 0, 0},
               {0, 1, 0.3f},
               {1, 1, 0},
               {2, 1, 1},
               {0, 2, 0},
               {1, 2, 0.2f},
               {2, 2, 0}},
              {{{0, 1, 4}},
               {{0, 4, 3}},
               {{1, 2, 4}},
               {{2, 5, 4}},
               {{3, 4, 6}},
               {{4, 7, 6}},
               {{4, 5, 8}},
               {{4, 8, 7}}});
}

/// Half a disk around a vertex of its border that has six neighbours.
Mesh bent_fan() {
  return cage({{0, 0, 0},
               {2, 0, 0.2f},
               {1.6f, 1.2f, 0.5f},
               {0.6f, 1.9f, -0.3f},
               {-0.6f, 1.9f, 0.6f},
               {-1.6f, 1.2f, 0},
               {-2, 0, 0.7f}},
              {{{0, 1, 2}}, {{0, 2, 3}}, {{0, 3, 4}}, {{0, 4, 5}}, {{0, 5, 6}}});
}

TEST(LoopSubdivision, TheLimitSurfaceIsThatOfAllLevels) {
  for (const Mesh& start : {octahedron(), bent_sheet()}) {
    const Mesh coarse = subdivide_loop(start, 0), fine = subdivide_loop(start, 4);
    EXPECT_EQ(fine.triangles.size(), 256 * start.triangles.size());
    // A vertex of the cage keeps its number.
    for (std::size_t i = 0; i < start.positions.size(); ++i) {
      expect_near(coarse.positions[i], fine.positions[i], 1e-5f);
      expect_near(coarse.normals[i], fine.normals[i], 1e-3f);
    }
  }
}

TEST(LoopSubdivision, NormalsAreThoseOfTheFineTriangles) {
  const Mesh fine = subdivide_loop(bent_sheet(), 6);
  for (const TriangleIndices& t : fine.triangles) {
    const Vec3& p = fine.positions[t.v[0]];
    const Vec3 n =
        glm::normalize(glm::cross(fine.positions[t.v[1]] - p, fine.positions[t.v[2]] - p));
    // As pbrt's, they point to where the triangles look clockwise from.
    for (const std::uint32_t v : t.v) ASSERT_GT(-dot(n, fine.normals[v]), 0.97f);
  }
}

/// The border's normals against the surface itself, made of finer and finer triangles. Where a
/// vertex of the border has more than four neighbours pbrt's formula is near after two levels.
TEST(LoopSubdivision, NormalsAtABorderAreThoseOfTheLimit) {
  const auto expect = [](const Mesh& start, int levels, float tolerance) {
    const Mesh coarse = subdivide_loop(start, levels), fine = subdivide_loop(start, 8);
    for (std::uint32_t v = 0; v < start.positions.size(); ++v) {
      Vec3 sum(0.0f);
      for (const TriangleIndices& t : fine.triangles) {
        if (t.v[0] != v && t.v[1] != v && t.v[2] != v) continue;
        const Vec3& p = fine.positions[t.v[0]];
        sum -= glm::normalize(glm::cross(fine.positions[t.v[1]] - p, fine.positions[t.v[2]] - p));
      }
      expect_near(coarse.normals[v], glm::normalize(sum), tolerance);
    }
  };
  expect(bent_sheet(), 0, 0.02f);
  expect(bent_fan(), 2, 0.04f);
}

/// pbrt-v4's LoopSubdivide at a vertex with six neighbours: T = sum of weights of the ring.
TEST(LoopSubdivision, ManyNeighboursAtABorderWeighAsInPbrt) {
  const Mesh fan = bent_fan();
  const double theta = double{pi} / 5;
  Vec3 t = static_cast<float>(std::sin(theta)) * (fan.positions[1] + fan.positions[6]);
  for (int k = 1; k <= 4; ++k) {
    t += static_cast<float>((2 * std::cos(theta) - 2) * std::sin(k * theta)) *
         fan.positions[static_cast<std::size_t>(k) + 1];
  }
  const Vec3 normal = glm::normalize(glm::cross(fan.positions[6] - fan.positions[1], -t));
  const Vec3 own = subdivide_loop(fan, 0).normals[0];
  EXPECT_NEAR(std::abs(dot(own, normal)), 1.0f, 1e-5f);
  EXPECT_LT(own.z, 0.0f);
}

TEST(LoopSubdivision, APlaneStaysAPlaneAndABorderStraight) {
  Mesh flat = bent_sheet();
  for (Vec3& p : flat.positions) p.z = 0.25f * p.x;
  for (const Vec3& p : subdivide_loop(flat, 3).positions) {
    EXPECT_NEAR(p.z, 0.25f * p.x, 1e-6f);
    EXPECT_LE(p.y, 2.0f);
  }
}

TEST(LoopSubdivision, WhatIsNoSurfaceIsAnError) {
  EXPECT_THROW(
      subdivide_loop(cage({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{{0, 1, 2}}, {{0, 1, 3}}}),
                     1),
      Error);
}

}  // namespace
}  // namespace pt
