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

TEST(Obj, BrokenFilesAreRefusedWithTheirLine) {
  const TempFolder folder;
  expect_error([&] { read_obj(folder.file("missing.obj")); }, "missing.obj: No such file");
  write_text(folder.file("a.obj"), "v 1 2\n");
  expect_error([&] { read_obj(folder.file("a.obj")); }, "a.obj: line 1: expected a number");
  const auto expect_error_of = [](const std::string& text, const std::string& part) {
    expect_error([&] { decode_obj(text, "a.obj"); }, part);
  };
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  expect_error_of(points + "v 1 x 1\n", "line 4: expected a number, found 'x'");
  expect_error_of(points + "\r\nv 1 nan 1\r\n", "line 5: position");
  expect_error_of(points + "v 1 2e38 -4e38\n", "line 4: position");
  expect_error_of(points + "f 1 2\n", "line 4: a face with 2 vertices");
  expect_error_of(points + "f 1 2 4\n", "line 4: vertex 4, of 3 so far");
  expect_error_of(points + "f 1 2 -4\n", "line 4: vertex -4, of 3 so far");
  expect_error_of(points + "f 1 2 0\n", "line 4: vertex 0, of 3 so far");
  expect_error_of(points + "f 1 2 99999999999999999999\n", "line 4: vertex 99999999999999999999");
  expect_error_of(points + "f 1/1 2/1 3/1\n", "line 4: texture vertex 1, of 0 so far");
  expect_error_of(points + "f 1//1 2//1 3//1\n", "line 4: normal 1, of 0 so far");
  expect_error_of(points + "f 1 2 3/\\\n///4\n", "line 5: ");
  expect_error_of(points + "f 1 2 x\n", "line 4: expected the number of a vertex, found 'x'");
}

class ObjMaterials : public testing::Test {
 protected:
  ObjFile read(const std::string& obj, const std::string& mtl) const {
    write_text(folder_.file("a.mtl"), mtl);
    write_text(folder_.file("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + obj);
    return read_obj_with_materials(folder_.file("a.obj"));
  }

  /// The one material of an MTL file.
  ObjMaterial read_material(const std::string& mtl) const {
    const ObjFile file = read("mtllib a.mtl\nusemtl m\nf 1 2 3\n", "newmtl m\n" + mtl);
    EXPECT_EQ(file.meshes.size(), 1u);
    return file.materials.at(file.meshes.at(0).material);
  }

  const TempFolder folder_;
};

TEST_F(ObjMaterials, AMeshForEachMaterial) {
  const ObjFile file = read(
      "mtllib a.mtl\nf 1 2 3\nusemtl red wine\nf 1 2 3\nf 3 2 1\nusemtl blue\nf 1 2 3\n"
      "usemtl red wine\nf 2 1 3\nusemtl nobody\nf 1 2 3\n",
      "newmtl red wine\nKd 1 0 0\nnewmtl unused\nKd 0 1 0\r\n\tnewmtl  blue\nKd 0 0 1\n");
  ASSERT_EQ(file.meshes.size(), 3u);
  std::size_t triangles_of_red = 0;
  for (const Mesh& mesh : file.meshes) {
    const ObjMaterial& material = file.materials.at(mesh.material);
    if (material.name == "red wine") {
      EXPECT_EQ(material.material.color(0), Color(1, 0, 0));
      triangles_of_red = mesh.triangles.size();
      EXPECT_EQ(mesh.positions.size(), 3u);
    }
    if (material.name.empty()) {
      EXPECT_EQ(mesh.triangles.size(), 2u);
    }
  }
  EXPECT_EQ(triangles_of_red, 3u);
  ASSERT_EQ(file.warnings.size(), 1u);
  EXPECT_NE(file.warnings[0].find("nobody"), std::string::npos);
}

TEST_F(ObjMaterials, NearestOfOurs) {
  const ObjMaterial diffuse = read_material("Kd 0.1 0.2 0.3\nKe 4 5 6\nmap_Kd tex\\a b.png\n");
  EXPECT_EQ(diffuse.material.kind, kind_of<Diffuse>);
  EXPECT_EQ(diffuse.material.color(0), Color(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(diffuse.material.emission.radiance, Color(4, 5, 6));
  EXPECT_EQ(diffuse.albedo_map, std::filesystem::path(folder_.file("tex/a b.png")));
  EXPECT_TRUE(diffuse.emission_map.empty());

  const ObjMaterial lamp = read_material("Kd 0 0 0\nmap_Ke glow.png\n");
  EXPECT_EQ(lamp.material.emission.radiance, Color(1));
  EXPECT_EQ(lamp.emission_map, std::filesystem::path(folder_.file("glow.png")));

  const ObjMaterial glass = read_material("Kd 0.1 0.2 0.3\nNi 1.33\nillum 7\n");
  EXPECT_EQ(glass.material.kind, kind_of<Dielectric>);
  EXPECT_FLOAT_EQ(glass.material.scalar(1), 1.33f);
  EXPECT_EQ(read_material("d 0.1\nNi 1\n").material.scalar(1), 1.5f);

  const ObjMaterial metal = read_material("Kd 0 0 0\nKs 0.9 0.8 0.7\nNs 198\nillum 3\n");
  EXPECT_EQ(metal.material.kind, kind_of<Metal>);
  EXPECT_EQ(metal.material.color(0), Color(0.9f, 0.8f, 0.7f));
  EXPECT_FLOAT_EQ(metal.material.scalar(1), 0.1f);

  EXPECT_EQ(read_material("Kd 7 -1 0.5\n").material.color(0), Color(1, 0, 0.5f));
}

// A highlight where the file asks for one (illum 2); its lobe is as wide as the half vector's.
TEST_F(ObjMaterials, Highlights) {
  const ObjMaterial glossy =
      read_material("Kd 0.1 0.2 0.3\nKs 0.4 0.5 0.6\nNs 80\nillum 2\nmap_Ks shine.png\n");
  EXPECT_EQ(glossy.material.kind, kind_of<Phong>);
  EXPECT_EQ(glossy.material.color(0), Color(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(glossy.material.color(1), Color(0.4f, 0.5f, 0.6f));
  EXPECT_EQ(glossy.material.scalar(2), 20.0f);
  EXPECT_EQ(glossy.specular_map.filename(), "shine.png");
  EXPECT_EQ(read_material("Kd 1 1 1\nKs 1 1 1\nillum 1\n").material.kind, kind_of<Diffuse>);
  EXPECT_EQ(read_material("Kd 1 1 1\nKs 0 0 0\nillum 2\n").material.kind, kind_of<Diffuse>);
  for (const double angle : {0.05, 0.1}) {  // of the mirrored ray: the exponents agree
    EXPECT_NEAR(std::pow(std::cos(angle), 20), std::pow(std::cos(angle / 2), 80), 1e-3);
  }
}

TEST_F(ObjMaterials, GlassHasAFilter) {
  const ObjMaterial green = read_material("Ni 1.4\nTf 0.2 0.9 0.3\nillum 6\n");
  EXPECT_EQ(green.material.kind, kind_of<RoughDielectric>);
  EXPECT_EQ(green.material.color(0), Color(1.0f));
  EXPECT_EQ(green.material.color(1), Color(0.2f, 0.9f, 0.3f));
  EXPECT_EQ(green.material.scalar(2), 1.4f);
  EXPECT_EQ(read_material("Tf 1 1 1\nillum 6\n").material.kind, kind_of<Dielectric>);
}

TEST_F(ObjMaterials, WhatIsLostIsSaid) {
  const ObjFile file = read("mtllib missing.mtl\nmtllib a.mtl\nf 1 2 3\n",
                            "newmtl m\nKd 0.5 0.5 0.5\nKs 1 1 1\nd 0.7\nmap_bump b.png\n");
  ASSERT_EQ(file.warnings.size(), 2u);
  EXPECT_EQ(file.warnings[0], "missing.mtl: No such file or directory");
  EXPECT_EQ(file.warnings[1], "material m: no highlights (Ks)");
}

TEST_F(ObjMaterials, MasksAndBumps) {
  const ObjMaterial thin = read_material("Kd 1 1 1\nd 0.7\n");
  EXPECT_FLOAT_EQ(thin.material.opacity.offset, 0.7f);
  const ObjMaterial leaf =
      read_material("Kd 1 1 1\nd 0.1\nmap_d leaf.png\nmap_bump -bm 0.3 b.png\n");
  EXPECT_EQ(leaf.material.kind, kind_of<Diffuse>);
  EXPECT_EQ(leaf.opacity_map.filename(), "leaf.png");
  EXPECT_EQ(leaf.bump_map.filename(), "b.png");
  EXPECT_FLOAT_EQ(leaf.bump_scale, 0.3f);
}

}  // namespace
}  // namespace pt
