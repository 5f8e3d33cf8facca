// A square with a picture, and a second material, as the exporters of big programs write them. The
// square is [0, 2] x [0, 2] at z = 0 and faces +z; its picture, head up, has red and green above
// blue and white. The texts are ours; what they imitate are names, comments, groups, indices,
// numbers and line ends.
#include "load/expect_near.h"
#include "load/obj_files.h"

namespace pt {
namespace {

struct Model {
  const char* exporter;
  std::string mtl_name, mtl, obj;
  std::string square, other;  ///< names of the two materials
  std::string square_is, other_is;
  bool is_smooth = true;     ///< it has normals, along +z
  std::string warning = {};  ///< part of the only one
};

std::string with_windows_ends(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '\n' ? "\r\n" : std::string(1, c);
  return result;
}

const std::string highlight = " 0 0 0 0 0 0 1";  ///< the rest of a principled material

const Model models[] = {
    {"Blender", "a.mtl",
     "# Blender 4.2.0 MTL File: 'a.blend'\n# www.blender.org\n\nnewmtl Glow\nNs 250.000000\n"
     "Ka 1.000000 1.000000 1.000000\nKs 0.000000 0.000000 0.000000\nKe 3.000000 2.000000 1.000000\n"
     "Ni 1.450000\nd 0.250000\nillum 9\n\nnewmtl Material.001\nNs 250.000000\n"
     "Ka 1.000000 1.000000 1.000000\nKs 0.500000 0.500000 0.500000\nKe 0.000000 0.000000 0.000000\n"
     "Ni 1.450000\nd 1.000000\nillum 2\nmap_Kd t.ppm\n",
     "# Blender 4.2.0\n# www.blender.org\nmtllib a.mtl\no Plane\nv 0.000000 0.000000 0.000000\n"
     "v 2.000000 0.000000 0.000000\nv 0.000000 2.000000 0.000000\nv 2.000000 2.000000 0.000000\n"
     "vn -0.0000 -0.0000 1.0000\nvt 1.000000 0.000000\nvt 0.000000 1.000000\n"
     "vt 0.000000 0.000000\nvt 1.000000 1.000000\ns 0\nusemtl Material.001\n"
     "f 1/3/1 2/1/1 4/4/1 3/2/1\no Lamp\nv 3 0 0\nv 3 0 3\nv 3 2 0\nusemtl Glow\nf 5/3/1 6/1/1 "
     "7/2/1\nl 1 2\n",
     "Material.001", "Glow", "principled 1* 0.5 0 0 1.45" + highlight,
     "diffuse 0.5 emits 3,2,1 opacity 0.25"},
    {"Maya", "a.mtl",
     "newmtl initialShadingGroup\nillum 4\nKd 0.50 0.50 0.50\nKa 0.00 0.00 0.00\n"
     "Tf 1.00 1.00 1.00\nmap_Kd t.ppm\nNi 1.00\nKs 0.00 0.00 0.00\nNs 18.00\n"
     "newmtl blinn1SG\nillum 4\nKd 0.00 0.00 0.00\nKa 0.00 0.00 0.00\nTf 0.00 0.00 0.00\n"
     "Ni 1.60\nKs 0.50 0.50 0.50\n",
     "# This file uses centimeters as units for non-parametric coordinates.\n\nmtllib a.mtl\n"
     "g default\nv 0.000000 0.000000 0.000000\nv 2.000000 0.000000 0.000000\n"
     "v 0.000000 2.000000 0.000000\nv 2.000000 2.000000 0.000000\nvt 0.000000 0.000000\n"
     "vt 1.000000 0.000000\nvt 0.000000 1.000000\nvt 1.000000 1.000000\nvn 0.000000 0.000000 "
     "1.000000\nvn 0.000000 0.000000 1.000000\nvn 0.000000 0.000000 1.000000\n"
     "vn 0.000000 0.000000 1.000000\ns off\ng pPlane1\nusemtl initialShadingGroup\n"
     "f 1/1/1 2/2/2 4/4/3 3/3/4\ng pPlane2\nusemtl blinn1SG\nf 1/1/1 2/2/2 4/4/3\n",
     "initialShadingGroup", "blinn1SG", "diffuse 0.5*", "dielectric 1 1.6"},
    {"3ds Max", "a b.mtl",
     with_windows_ends(
         "# 3ds Max Wavefront OBJ Exporter v0.97b - (c)2007 guruware\n\nnewmtl Material #25\n"
         "\tNs 10.0000\n\tNi 1.5000\n\td 1.0000\n\tTr 0.0000\n\tTf 1.0000 1.0000 1.0000 \n"
         "\tillum 2\n\tKa 0.5880 0.5880 0.5880\n\tKd 0.5880 0.5880 0.5880\n"
         "\tKs 0.0000 0.0000 0.0000\n\tKe 0.0000 0.0000 0.0000\n"
         "\tmap_Ka C:\\Users\\me\\Desktop\\t.ppm\n\tmap_Kd C:\\Users\\me\\Desktop\\t.ppm\n\n"
         "newmtl wire_008110134\n\tNs 32\n\td 1\n\tTr 0\n\tTf 1 1 1\n\tillum 2\n"
         "\tKa 0.0314 0.4314 0.5255\n\tKd 0.0314 0.4314 0.5255\n\tKs 0.3500 0.3500 0.3500\n"),
     with_windows_ends(
         "# 3ds Max Wavefront OBJ Exporter v0.97b - (c)2007 guruware\n# File Created: 01.02.2020 "
         "12:00:00\n\nmtllib a b.mtl\n\n#\n# object Plane001\n#\n\nv  0.0000 0.0000 0.0000\n"
         "v  2.0000 0.0000 0.0000\nv  0.0000 2.0000 0.0000\nv  2.0000 2.0000 0.0000\n"
         "# 4 vertices\n\nvn 0.0000 0.0000 1.0000\n# 1 vertex normals\n\nvt 0.0000 0.0000 0.0000\n"
         "vt 1.0000 0.0000 0.0000\nvt 0.0000 1.0000 0.0000\nvt 1.0000 1.0000 0.0000\n"
         "# 4 texture coords\n\ng Plane001\nusemtl Material #25\ns 1\n"
         "f 3/3/1 1/1/1 2/2/1 \nf 2/2/1 4/4/1 3/3/1 \n# 2 faces\n\ng Plane002\n"
         "usemtl wire_008110134\ns 1\nf 3/3/1 1/1/1 2/2/1 \n"),
     "Material #25", "wire_008110134", "diffuse 0.588*",
     "principled 0.0314,0.4314,0.5255 0.8211 0 0 1.402" + highlight, true, "does not exist"},
    {"ZBrush", "a.mtl",
     "newmtl skin\nillum 4\nKd 1.00 1.00 1.00\nKa 0.00 0.00 0.00\n"
     "Tf 1.00 1.00 1.00\nmap_Kd t.ppm\nNi 1.00\nnewmtl eye\nKd 0 0 1\nillum 1\n",
     "#Wavefront OBJ file\n#Exported by ZBrush version 4R8\n#Vertex Count 4\n#Face Count 1\n"
     "#Auto scale x=1.0 y=1.0 z=1.0\nmtllib a.mtl\nusemtl skin\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 "
     "0\n"
     "#MRGB ffffffffffffffffffffffffffffffff\n#End of MRGB block\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
     "g default\nf 1/1 2/2 3/3 4/4\ng eye\nusemtl eye\nf 1/1 2/2 3/3 \n",
     "skin", "eye", "diffuse 1*", "diffuse 0,0,1", false},
    {"three.js", "a.mtl", "newmtl mat\nKd 0.25 0.5 1\nmap_Kd t.ppm\nillum 0\nnewmtl b\nKd 1 0 0\n",
     "mtllib a.mtl\no \nv 0 2 0\nv 2 2 0\nv 0 0 0\nv 2 0 0\nvt 0 1\nvt 1 1\nvt 0 0\nvt 1 0\n"
     "vn 0 0 1\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\nusemtl mat\nf 1/1/1 3/3/3 2/2/2\n"
     "f 3/3/3 4/4/4 2/2/2\no line\nv 9 9 9\nv 8 8 8\nl 5 6 \no b\nusemtl b\nf 1/1/1 3/3/3 2/2/2\n",
     "mat", "b", "diffuse 0.25,0.5,1*", "diffuse 1,0,0"},
    {"assimp", "a.obj.mtl",
     "# File produced by Open Asset Import Library (http://www.assimp.sf.net)\n# (assimp "
     "v5.2.0)\n\n"
     "newmtl DefaultMaterial\nKd 0.6 0.6 0.6\nKs 0.5 0.5 0.5\nd 1\nNs 90\nillum 2\n"
     "map_Kd .\\textures\\t.ppm\n\nnewmtl $b\nKd 0 1 0\nTr 0.25\nillum 1\n",
     "# File produced by Open Asset Import Library (http://www.assimp.sf.net)\n# (assimp "
     "v5.2.0)\n\n"
     "mtllib a.obj.mtl\n\n# 4 vertex positions\nv  0 0 0\nv  2 0 0\nv  2 2 0\nv  0 2 0\n\n"
     "# 4 UV coordinates\nvt 0 0 0\nvt 1 0 0\nvt 1 1 0\nvt 0 1 0\n\n# 1 vertex normals\nvn 0 0 "
     "1\n\n"
     "# Mesh '' with 1 faces\ng \nusemtl DefaultMaterial\nf  1/1/1 2/2/1 3/3/1 4/4/1\n\n"
     "g b\nusemtl $b\nf  1/1/1 2/2/1 3/3/1\n",
     "DefaultMaterial", "$b", "principled 0.6* 0.7 0 0 1.5" + highlight,
     "diffuse 0,1,0 opacity 0.75"},
    {"MeshLab", "a.obj.mtl",
     "#\n# Wavefront material file\n# Converted by Meshlab Group\n#\n\nnewmtl material_0\n"
     "Ka 0.200000 0.200000 0.200000\nKd 1.000000 1.000000 1.000000\nKs 1.000000 1.000000 1.000000\n"
     "Tr 1.000000\nillum 2\nNs 0.000000\nmap_Kd t.ppm\n\nnewmtl material_1\nKd 0 1 0\nd 1\n",
     "####\n#\n# OBJ File Generated by Meshlab\n#\n####\n# Object a.obj\n#\n# Vertices: 4\n# "
     "Faces: 2"
     "\n#\n####\nmtllib ./a.obj.mtl\n\nvn 0.000000 0.000000 6.283185\nv 0 0 0\nvn 0.0 0.0 1.57\n"
     "v 2 0 0\nvn 0 0 1.5\nv 2 2 0\nvn 0 0 1.5\nv 0 2 0\n# 4 vertices, 0 vertices normals\n\n"
     "vt 0.000000 0.000000\nvt 1.000000 0.000000\nvt 1.000000 1.000000\nvt 0.000000 1.000000\n"
     "usemtl material_0\nf 1/1/1 2/2/2 3/3/3\nf 1/1/1 3/3/3 4/4/4\nusemtl material_1\n"
     "f 1/1/1 2/2/2 3/3/3\n# 2 faces, 4 coords texture\n\n# End of File\n",
     "material_0", "material_1", "principled 1* 1 0 0 1.789" + highlight, "diffuse 0,1,0", true,
     "Tr 1 of MeshLab"},
    {"SketchUp", "my model.mtl",
     with_windows_ends(
         "## Alias OBJ Material File\n# Exported from SketchUp, (c) 2000-2012 Trimble\n\n"
         "newmtl Wood_Floor\nKa 0.000000 0.000000 0.000000\nKd 1.000000 1.000000 1.000000\n"
         "Ks 0.000000 0.000000 0.000000\nmap_Kd my model/t.ppm\n\nnewmtl Glass_Blue\n"
         "Ka 0.000000 0.000000 0.000000\nKd 0.250980 0.501961 1.000000\n"
         "Ks 0.000000 0.000000 0.000000\nd 0.500000\n\nnewmtl FrontColor\nKd 1 1 1\n"),
     with_windows_ends(
         "# Alias OBJ Model File\n# Exported from SketchUp, (c) 2000-2012 Trimble\n"
         "# File units = meters\n\nmtllib my model.mtl\n\ng Mesh1 Model\n\nusemtl Wood_Floor\n"
         "v 0 0 0\nvt 0 0\nvn 0 0 1\nv 2 0 0\nvt 1 0\nv 2 2 0\nvt 1 1\nv 0 2 0\nvt 0 1\n"
         "f 1/1/1 2/2/1 3/3/1 4/4/1 \n\ng Mesh2 Glass Model\n\nusemtl Glass_Blue\n"
         "f 4/4/1 3/3/1 2/2/1 \n"),
     "Wood_Floor", "Glass_Blue", "diffuse 1*", "diffuse 0.251,0.502,1 opacity 0.5"},
    {"Rhino", "a.mtl",
     "# Rhino\nnewmtl diffuse_0_255_0_255\nKa 0.0000 0.0000 0.0000\nKd 0.0000 1.0000 0.0000\n"
     "Ks 1.0000 1.0000 1.0000\nTf 0.0000 0.0000 0.0000\nd 1.0000\nNs 0\nillum 1\n"
     "newmtl Picture\nKa 0.0000 0.0000 0.0000\nKd 1.0000 1.0000 1.0000\nTf 0.0000 0.0000 0.0000\n"
     "d 1.0000\nNs 0.0000\nmap_Kd t.ppm\n",
     "# Rhino\n\nmtllib a.mtl\ng Plane \\\nfirst\nusemtl Picture\nv 0 0 0\nv 1 0 0\nv 2 \\\n0 0\n"
     "v 2 2 0\nv 0 2 0\nvt 0 0\nvt 0.5 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n"
     "f 1/1/1 2/2/1 3/3/1 \\\n4/4/1 \\\n5/5/1\nusemtl diffuse_0_255_0_255\nf 1/1/1 2/2/1 4/4/1\n",
     "Picture", "diffuse_0_255_0_255", "diffuse 1*", "diffuse 0,1,0"},
    {"Houdini", "a.mtl",
     "newmtl /shop/wood\nKd 1 1 1\nmap_Kd t.ppm\nillum 1\nnewmtl /shop/lamp\nKd 0 0 0\nKe 5 5 5\n",
     "# Wavefront OBJ\n# File created by Houdini\nmtllib a.mtl\n# 4 points\nv 0 0 0 1\nv 2 0 0 1\n"
     "v 2 2 0 1\nv 0 2 0 1\n# 4 vertices\nvt 0 0 0\nvt 1 0 0\nvt 1 1 0\nvt 0 1 0\nvn 0 0 1\n"
     "# 1 primitives\ng all wood\nusemtl /shop/wood\nf 1/1/1 2/2/1 3/3/1 4/4/1\ng lamp\nv 3 0 0 "
     "1\nv 3 0 3 1\nv 3 2 0 1\n"
     "usemtl /shop/lamp\nf -3/-4/-1 -2/-3/-1 -1/-2/-1\n",
     "/shop/wood", "/shop/lamp", "diffuse 1*", "diffuse 0 emits 5"},
    {"Cinema 4D", "a.mtl",
     "# WaveFront *.mtl file (generated by CINEMA 4D)\n\nnewmtl Mat.1\nKa 1.00000 1.00000 1.00000\n"
     "Kd 0.78431 0.78431 0.78431\nKs 1.00000 1.00000 1.00000\nNs 50.00000\nmap_Kd t.ppm\nillum 7\n"
     "\nnewmtl Mat\nKa 1.00000 1.00000 1.00000\nKd 0.78431 0.00000 0.00000\n"
     "Ks 1.00000 1.00000 1.00000\nNs 40.00000\nillum 7\n",
     "# WaveFront *.obj file (generated by CINEMA 4D)\n\nmtllib ./a.mtl\n\ng Plane\nusemtl Mat.1\n"
     "v 0 0 0\nv 0 2 0\nv 2 2 0\nv 2 0 0\n# 4 vertices\n\nvn 0 0 1\n# 1 normals\n\nvt 0 0 0\n"
     "vt 0 1 0\nvt 1 1 0\nvt 1 0 0\n# 4 texture coordinates\n\nf 4/4/1 3/3/1 2/2/1 1/1/1 \n# 1 "
     "elements\n\ng Other\nusemtl Mat\nf 4/4/1 3/3/1 2/2/1 \n",
     "Mat.1", "Mat", "principled 0.7843* 0.7764 0 0 1.789" + highlight,
     "principled 0.7843,0,0 0.8 0 0 1.789" + highlight},
    {"Wings 3D", "a.mtl",
     "# Exported from Wings 3D 2.2.6\nnewmtl default\nNs 89.99999999999999\nd 1.00000\nillum 2\n"
     "Kd 1.00000 1.00000 1.00000\nKa 0.789 0.815 1.00000\nKs 0.25 0.25 0.25\n"
     "Ke 0.00000e+0 0.00000e+0 0.00000e+0\nmap_Kd \"t.ppm\"\n\nnewmtl cube1_auv\nd 0.50000\n"
     "illum 1\nKd 1.00000e-1 0.20000 0.30000\n",
     "# Exported from Wings 3D 2.2.6\nmtllib a.mtl\no cube1\n#4 vertices, 1 faces\n"
     "v 0.00000000 0.00000000 0.00000000\nv 2.00000000 0.00000000 0.00000000\n"
     "v 2.00000000 2.00000000 0.00000000\nv 0.00000000 2.00000000 0.00000000\nvt 0.0 0.0\n"
     "vt 1.0 0.0\nvt 1.0 1.0\nvt 0.0 1.0\nvn 0.00000000 0.00000000 1.00000000\n"
     "g cube1_default\nusemtl default\nf 1/1/1 2/2/1 3/3/1 4/4/1\ng cube1_auv\nusemtl cube1_auv\n"
     "f 1/1/1 2/2/1 3/3/1\n",
     "default", "cube1_auv", "principled 1* 0.7 0 0 1.329" + highlight,
     "diffuse 0.1,0.2,0.3 opacity 0.5"},
};

/// What the material's first parameter is at a point of the mesh, seen along -z; black beside it.
Color color_at(const LoadedObj& file, const Mesh& mesh, double x, double y) {
  const Parameter& parameter = file.scene.materials.at(mesh.material).parameters[0];
  for (const TriangleIndices& t : mesh.triangles) {
    const auto edge = [&](int i, int j, double px, double py) {
      const Vec3 a = mesh.positions[t.v[i]], b = mesh.positions[t.v[j]];
      return (double{b.x} - a.x) * (py - a.y) - (double{b.y} - a.y) * (px - a.x);
    };
    const double area = edge(0, 1, mesh.positions[t.v[2]].x, mesh.positions[t.v[2]].y);
    const double w[3] = {edge(1, 2, x, y) / area, edge(2, 0, x, y) / area, edge(0, 1, x, y) / area};
    if (!(area > 0) || w[0] < -1e-9 || w[1] < -1e-9 || w[2] < -1e-9) continue;
    Vec2 uv(0.0f);
    for (int i = 0; i < 3; ++i) uv += static_cast<float>(w[i]) * mesh.uvs.at(t.v[i]);
    return parameter.value * file.texture_at(parameter.texture, uv);
  }
  return Color(0.0f);
}

const Mesh& mesh_of(const LoadedObj& file, const std::string& name) {
  for (const Mesh& mesh : file.scene.meshes) {
    const auto known = file.scene.names.materials.find(mesh.material);
    if (known != file.scene.names.materials.end() && known->second == name) return mesh;
  }
  throw Error("no mesh of " + name);
}

TEST(ObjExporters, SquaresFaceTheViewerWithTheirPictureHeadUp) {
  for (const Model& model : models) {
    SCOPED_TRACE(model.exporter);
    const ObjFolder folder;
    folder.write(model.mtl_name, model.mtl);
    for (const char* place : {"t.ppm", "textures/t.ppm", "my model/t.ppm"}) {
      folder.write(place, four_colors);
    }
    const LoadedObj file = folder.load(model.obj);
    EXPECT_EQ(text_of(file.scene, file.material(model.square)), model.square_is);
    EXPECT_EQ(text_of(file.scene, file.material(model.other)), model.other_is);
    EXPECT_EQ(file.scene.meshes.size(), 2u);
    const Mesh& square = mesh_of(file, model.square);
    const Color kd = file.material(model.square).parameters[0].value;
    const Color expected[4] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
    for (int i = 0; i < 4; ++i) {
      expect_near(color_at(file, square, i % 2 ? 1.5 : 0.5, i < 2 ? 1.5 : 0.5), kd * expected[i]);
    }
    EXPECT_EQ(square.normals.empty(), !model.is_smooth);
    for (const Vec3& normal : square.normals) expect_near(normal, {0, 0, 1});
    EXPECT_EQ(file.warnings.size(), model.warning.empty() ? 0u : 1u);
    for (const std::string& warning : file.warnings) {
      EXPECT_NE(warning.find(model.warning), std::string::npos) << warning;
    }
  }
}

}  // namespace
}  // namespace pt
