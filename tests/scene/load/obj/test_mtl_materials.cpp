// MTL statements and the materials that they become: docs/scenes.md has the rules.
#include "load/obj_files.h"

namespace pt {
namespace {

struct Case {
  std::string statements, material;
  std::string warning = {};  ///< part of the only one; empty: there is none
};

void expect_materials(const std::vector<Case>& cases) {
  const ObjFolder folder;
  folder.write("t.ppm", four_colors);
  for (const Case& c : cases) {
    const LoadedObj file = folder.load_m(c.statements);
    EXPECT_EQ(text_of(file.scene, file.material("m")), c.material) << c.statements;
    EXPECT_EQ(file.warnings.size(), c.warning.empty() ? 0u : 1u) << c.statements;
    for (const std::string& warning : file.warnings) {
      EXPECT_NE(warning.find(c.warning), std::string::npos) << c.statements << warning;
    }
  }
}

TEST(Mtl, Colors) {
  expect_materials({
      {"Kd 0.1 0.2 0.3", "diffuse 0.1,0.2,0.3"},
      {"kd 0.1 0.2 0.3 # comment", "diffuse 0.1,0.2,0.3"},
      {"Kd 0.4", "diffuse 0.4"},
      {"Kd 0.4 0.4", "diffuse 0.5", "line 2: material 'm': Kd: expected 1 or 3 numbers, found 2"},
      {"Kd", "diffuse 0.5", "Kd: expected 1 or 3 numbers, found 0"},
      {"Kd 0.4 x 0.4", "diffuse 0.5", "expected a number, found 'x': the statement is ignored"},
      {"Kd nan 0 0", "diffuse 0.5", "Kd: nan: the statement is ignored"},
      {"Kd 7 0 0.5", "diffuse 1,0,0.5", "Kd 7: expected a number in [0, 1], 1 is used"},
      {"Kd 0.5 0 -1", "diffuse 0.5,0,0", "Kd -1: expected a number in [0, 1], 0 is used"},
      {"Kd 1.0005 1 -0.0005", "diffuse 1,1,0"},
      {"Kd 0.1 0.2 0.3\nKd 0.4 0.5 0.6", "diffuse 0.4,0.5,0.6", "a second Kd: the last one"},
      {"Kd 0.1 0.2 0.3\nKd 0.1 0.2 0.3", "diffuse 0.1,0.2,0.3"},
      // D65 of luminance 0.5 is grey.
      {"Kd xyz 0.475235 0.5 0.544415", "diffuse 0.5"},
      {"Kd spectral file.rfl", "diffuse 0.5", "expected a number, found 'spectral'"},
      // Without a colour: grey, and white under a picture.
      {"illum 1", "diffuse 0.5"},
      {"map_Kd t.ppm", "diffuse 1*"},
      {"Kd 0.25 0.5 1\nmap_Kd t.ppm", "diffuse 0.25,0.5,1*"},
      {"Kd 0.25 0.5 1\nmap_Kd no.ppm", "diffuse 0.25,0.5,1",
       "map_Kd 'no.ppm': no such file: Kd alone is used"},
      {"map_Kd no.ppm", "diffuse 0.5", "map_Kd 'no.ppm': no such file: grey is used"},
      {"Ka 1 1 1\nmap_Ka no.ppm\nsharpness 60", "diffuse 0.5"},
  });
}

// White is CIE XYZ of more than 1 (IEC 61966-2-1), which is no number out of range.
TEST(Mtl, WhiteInXyz) {
  const ObjFolder folder;
  const LoadedObj file = folder.load_m("Kd xyz 0.9505 1.0 1.0890\nillum 1");
  EXPECT_TRUE(file.warnings.empty());
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(file.material("m").color(0)[i], 1.0f, 1e-3f);
}

TEST(Mtl, Emission) {
  expect_materials({
      {"Kd 0 0 0\nKe 4 5 6", "diffuse 0 emits 4,5,6"},
      {"Kd 0 0 0\nKe 1e9 0 0", "diffuse 0 emits 1e+09,0,0"},
      {"Kd 0 0 0\nKe -1 0 0", "diffuse 0", "Ke -1: expected a number >= 0, 0 is used"},
      {"Kd 0 0 0\nKe inf 0 0", "diffuse 0 emits 1e+30,0,0", "Ke inf"},
      {"Kd 0 0 0\nmap_Ke t.ppm", "diffuse 0 emits 1*"},
      {"Kd 0 0 0\nKe 0 0 0\nmap_Ke t.ppm", "diffuse 0 emits 1*"},
      {"Kd 0 0 0\nKe 3 2 1\nmap_Ke t.ppm", "diffuse 0 emits 3,2,1*"},
      {"Kd 0 0 0\nKe 3 2 1\nmap_Ke no.ppm", "diffuse 0 emits 3,2,1", "Ke alone is used"},
      {"Kd 0 0 0\nmap_Ke no.ppm", "diffuse 0", "nothing is emitted"},
      {"Kd 0 0 0\nKs 1 1 1\nillum 3\nKe 1 2 3", "metal 1 0.8165 emits 1,2,3"},
  });
}

// d and Tr at every value.
TEST(Mtl, Opacity) {
  expect_materials({
      {"Kd 0.5 0.5 0.5\nd 1", "diffuse 0.5"},
      {"Kd 0.5 0.5 0.5\nd 0.6", "diffuse 0.5 opacity 0.6"},
      {"Kd 0.5 0.5 0.5\nd 0.49", "diffuse 0.5 opacity 0.49"},
      {"Kd 0.5 0.5 0.5\nd 0.1\nNi 1", "diffuse 0.5 opacity 0.1"},
      {"Kd 0.5 0.5 0.5\nd 0", "diffuse 0.5 opacity 0"},
      {"Kd 0 0 0\nKe 0 0 1\nd 0.3", "diffuse 0 emits 0,0,1 opacity 0.3"},
      {"Kd 0.5 0.5 0.5\nD 0.3", "diffuse 0.5 opacity 0.3"},
      {"Kd 0.5 0.5 0.5\nTr 0.25", "diffuse 0.5 opacity 0.75"},
      {"Kd 0.5 0.5 0.5\nTr 0.9", "diffuse 0.5 opacity 0.1"},
      {"Kd 0.5 0.5 0.5\nTr 0", "diffuse 0.5"},
      {"Kd 0.5 0.5 0.5\nTr 1", "diffuse 0.5 opacity 0"},
      {"# Converted by Meshlab Group\nKd 0.5 0.5 0.5\nTr 1", "diffuse 0.5", "Tr 1 of MeshLab"},
      {"# Converted by Meshlab Group\nKd 0.5 0.5 0.5\nTr 0.5", "diffuse 0.5 opacity 0.5"},
      {"Kd 0.5 0.5 0.5\nd 0.4\nTr 0.6", "diffuse 0.5 opacity 0.4"},
      {"Kd 0.5 0.5 0.5\nd 0.4\nTr 0.4", "diffuse 0.5 opacity 0.4", "d and Tr contradict"},
      {"Kd 0.5 0.5 0.5\nTr 0.4\nd 0.4", "diffuse 0.5 opacity 0.4", "d and Tr contradict"},
      {"Kd 0.5 0.5 0.5\nd -halo 0.6", "diffuse 0.5 opacity 0.6", "d -halo"},
      {"Kd 0.5 0.5 0.5\nd 1.5", "diffuse 0.5", "d 1.5: expected a number in [0, 1], 1 is used"},
      {"Kd 0.5 0.5 0.5\nTr 1.5", "diffuse 0.5 opacity 0", "Tr 1.5: expected a number in [0, 1]"},
      {"Kd 0.5 0.5 0.5\nd -2", "diffuse 0.5 opacity 0", "0 is used"},
      {"Kd 0.5 0.5 0.5\nmap_d t.ppm", "diffuse 0.5 opacity 0+1*"},
      {"Kd 0.5 0.5 0.5\nd 0.5\nmap_d t.ppm", "diffuse 0.5 opacity 0+0.5*"},
      {"Kd 0.5 0.5 0.5\nd 0\nmap_d t.ppm", "diffuse 0.5 opacity 0+1*"},
      {"Kd 0.5 0.5 0.5\nd 0.5\nmap_d -mm 0.2 0.6 t.ppm", "diffuse 0.5 opacity 0.1+0.3*"},
      {"Kd 0.5 0.5 0.5\nmap_Tr t.ppm", "diffuse 0.5 opacity 1-1*"},
      {"Kd 0.5 0.5 0.5\nTr 0.5\nmap_Tr -mm 0.2 0.6 t.ppm", "diffuse 0.5 opacity 0.9-0.3*"},
      {"Kd 0.5 0.5 0.5\nd 0.7\nmap_d no.ppm", "diffuse 0.5 opacity 0.7", "d alone is used"},
      {"Kd 0.5 0.5 0.5\nd 0\nmap_d no.ppm", "diffuse 0.5", "d alone is used"},
      {"Kd 0.5 0.5 0.5\nillum 7\nmap_d t.ppm", "diffuse 0.5 opacity 0+1*"},
  });
}

TEST(Mtl, Glass) {
  expect_materials({
      {"illum 4", "dielectric 1 1.5"},
      {"illum 6\nNi 1.33", "dielectric 1 1.33"},
      {"illum 7\nNi 1.33\nKd 0.1 0.2 0.3", "dielectric 1 1.33"},
      {"illum 9\nNi 1.33", "dielectric 1 1.33"},
      {"illum 7\nNi 1", "dielectric 1 1.5"},
      {"illum 7\nNi 5", "dielectric 1 1.5"},
      {"illum 7\nNi 4.99", "dielectric 1 4.99"},
      {"illum 7\nNi 1.001", "dielectric 1 1.001"},
      {"illum 6\nNi 1.4\nTf 0.2 0.9 0.3", "rough dielectric 1 0.2,0.9,0.3 1.4 0 0 0"},
      {"illum 6\nTf 1 1 1", "dielectric 1 1.5"},
      {"illum 6\nTf 0 0 0", "dielectric 1 1.5"},
      {"illum 7\nPr 0.5", "rough dielectric 1 1 1.5 0.25 0.25 0"},
      {"illum 7\nd 0.3", "dielectric 1 1.5", "glass lets light pass by itself: d and Tr"},
      {"illum 4\nNi 1.5\nd 0.3", "dielectric 1 1.5", "glass lets light pass by itself: d and Tr"},
      {"illum 7\nNi 1.5\nmap_Kd t.ppm", "dielectric 1 1.5", "glass: map_Kd and map_Ks are ignored"},
      {"illum 7\nmap_Kd t.ppm", "diffuse 1*"},
      // Blender's alpha.
      {"illum 9\nNi 1.45\nd 0.3\nKd 0.1 0.2 0.3", "diffuse 0.1,0.2,0.3 opacity 0.3"},
      // Maya writes illum 4, Tf and Ni for everything; glass is what has an index.
      {"illum 4\nKd 0.5 0.6 0.7\nTf 1 1 1\nNi 1", "diffuse 0.5,0.6,0.7"},
      {"illum 4\nKd 0.5 0.6 0.7\nTf 0.25 0.25 0.25\nNi 1", "diffuse 0.5,0.6,0.7 opacity 0.25"},
      {"illum 4\nKd 0.5 0.6 0.7\nTf 0 0 0\nNi 1.8\nKs 1 1 1", "dielectric 1 1.8"},
      // Ni with Tf.
      {"Ni 1.5\nTf 1 1 1", "dielectric 1 1.5"},
      {"Ni 1.5\nTf 0.5 1 1", "rough dielectric 1 0.5,1,1 1.5 0 0 0"},
      {"Ni 1.5\nTf 0 0 0", "diffuse 0.5"},
      {"Ni 1\nTf 1 1 1", "diffuse 0.5"},
      {"Tf 1 1 1", "diffuse 0.5"},
      {"Ni 1.5", "diffuse 0.5"},
      {"illum 2\nNi 1.5\nTf 0.5 1 1", "rough dielectric 1 0.5,1,1 1.5 0 0 0"},
      {"illum 2\nNi 1.5\nTf 1 1 1", "diffuse 0.5"},  // 3ds Max
      {"illum 2\nNi 1.5\nTf 0.5 1 1\nd 1", "diffuse 0.5"},
      {"illum 2\nNi 1.5\nTf 0.5 1 1\nTr 0", "diffuse 0.5"},
  });
}

// The index 1.5 reflects 0.04, so that Ks 0.25 is 0.02 and the index 1.329; Ns 250 is the roughness
// 1 - sqrt(0.25), Ns 90 is 0.7.
TEST(Mtl, Highlights) {
  const std::string end = " 0 0 0 0 0 0 1";
  expect_materials({
      {"Kd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nNs 250\nNi 1.45\nd 1\nillum 2",
       "principled 0.8 0.5 0 0 1.45" + end},
      {"Kd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nNs 90\nNi 1\nillum 2", "principled 0.8 0.7 0 0 1.5" + end},
      {"Kd 0.8 0.8 0.8\nKs 0.25 0.25 0.25\nNs 90\nillum 2", "principled 0.8 0.7 0 0 1.329" + end},
      {"Kd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nillum 2", "principled 0.8 0.5 0 0 1.5" + end},
      {"Kd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nNs 1000\nillum 2", "principled 0.8 0 0 0 1.5" + end},
      {"Kd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nNs 2000\nillum 2", "principled 0.8 0 0 0 1.5" + end},
      {"Kd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nNs 0\nillum 2", "principled 0.8 1 0 0 1.5" + end},
      // A dark material with an index; without one its highlight is more than it has else.
      {"Kd 0 0 0\nKs 0.5 0.5 0.5\nNs 90\nNi 1.5\nillum 2", "principled 0 0.7 0 0 1.5" + end},
      {"Kd 0 0 0\nKs 0.9 0.9 0.9\nNs 80\nillum 2", "phong 0 0.9 20"},
      // In colour.
      {"Kd 0.1 0.2 0.3\nKs 0.4 0.5 0.6\nNs 80\nillum 2", "phong 0.1,0.2,0.3 0.4,0.5,0.6 20"},
      {"Kd 0.1 0.2 0.3\nKs 0.4 0.5 0.6\nillum 2", "phong 0.1,0.2,0.3 0.4,0.5,0.6 0.25"},
      {"Kd 0.1 0.2 0.3\nKs 0.4 0.5 0.6\nillum 2\nmap_Ks t.ppm\nmap_Kd t.ppm",
       "phong 0.1,0.2,0.3* 0.4,0.5,0.6* 0.25"},
      {"Kd 0.1 0.2 0.3\nKs 0.4 0.5 0.6\nillum 2\nmap_Ks no.ppm",
       "phong 0.1,0.2,0.3 0.4,0.5,0.6 "
       "0.25",
       "map_Ks 'no.ppm': no such file: Ks alone is used"},
      // A grey one under a map is the blend of the material without and with it.
      {"Kd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nNs 90\nillum 2\nmap_Ks t.ppm",
       "blend 1* (principled 0.8 0.7 0 0 1" + end + ") (principled 0.8 0.7 0 0 1.5" + end + ")"},
      {"Kd 1 1 1\nNs 90\nillum 2\nmap_Ks no.ppm", "principled 1 0.7 0 0 1.789" + end,
       "Ks alone is used"},
      {"Kd 1 1 1\nKs 0 0 0\nillum 2", "diffuse 1"},
      {"Kd 1 1 1\nKs 1 1 1\nillum 1", "diffuse 1"},
      {"Kd 1 1 1\nKs 1 1 1", "diffuse 1", "no highlights (Ks) without illum 2"},
      {"Kd 1 1 1\nKs 1 1 1\nillum 0", "diffuse 1", "no highlights (Ks) without illum 2"},
      {"Kd 1 1 1\nKs 0.05 0.05 0.05", "diffuse 1"},
      {"illum 11", "diffuse 0.5", "illum 11: expected a number in [0, 10]"},
      {"illum x", "diffuse 0.5", "illum: expected a number, found 'x'"},
  });
}

// sqrt(2 / (198 + 2)) is 0.1.
TEST(Mtl, Metals) {
  const std::string end = " 0 0 0 0 0 0 1";
  expect_materials({
      {"Kd 0 0 0\nKs 0.9 0.8 0.7\nNs 198\nillum 3", "metal 0.9,0.8,0.7 0.1"},
      {"Kd 0 0 0\nKs 0.9 0.8 0.7\nNs 198\nillum 5", "metal 0.9,0.8,0.7 0.1"},
      {"Kd 0 0 0\nKs 0.9 0.8 0.7\nNs 198\nillum 8\nmap_Ks t.ppm", "metal 0.9,0.8,0.7* 0.1"},
      {"Kd 0.9 0.8 0.7\nKs 0.5 0.5 0.5\nNs 90\nNi 1.5\nillum 3",
       "principled 0.9,0.8,0.7 0.7 0 0 1.5" + end},
      {"# Blender 4.2.0 MTL File\nKa 1 1 1\nKd 0.9 0.8 0.7\nKs 0.5 0.5 0.5\nNs 90\nNi 1.5\nillum 3",
       "principled 0.9,0.8,0.7 0.7 1 0 1.5" + end},
      {"# Blender 4.2.0 MTL File\nKa 1 1 1\nKd 0.9 0.8 0.7\nKs 0.5 0.5 0.5\nNs 90\nNi 1.5\nillum 2",
       "principled 0.9,0.8,0.7 0.7 0 0 1.5" + end},
  });
}

TEST(Mtl, PhysicalExtension) {
  expect_materials({
      {"Kd 0.8 0.8 0.8\nPr 0.25", "principled 0.8 0.25 0 0 1.5 0 0 0 0 0 0 1"},
      {"Kd 0.8 0.8 0.8\nPr 0.25\nNs 10\nPm 0.75\nNi 1.4",
       "principled 0.8 0.25 0.75 0 1.4 0 0 0 0 0 0 1"},
      {"Kd 0.8 0.8 0.8\nPm 1\nNs 90\nKs 0 0 0", "principled 0.8 0.7 1 0 1.001 0 0 0 0 0 0 1"},
      {"Kd 0.8 0.8 0.8\nPs 0.5\nPr 1", "principled 0.8 1 0 0 1.5 0 0 0.5 0 0 0 1"},
      // The coat's gloss: (0.1 - 0.2^2) / 0.099.
      {"Kd 0.8 0.8 0.8\nPc 0.75\nPcr 0.2\nPr 1", "principled 0.8 1 0 0 1.5 0 0 0 0 0 0.75 0.6061"},
      {"Kd 0.8 0.8 0.8\naniso 0.3\nPr 1", "principled 0.8 1 0 0 1.5 0.3 0 0 0 0 0 1"},
      {"Kd 0.8 0.8 0.8\nanisor 0.3\nPr 1", "principled 0.8 1 0 0 1.5 0 0 0 0 0 0 1",
       "unknown statement 'anisor'"},
      {"Kd 0.8 0.8 0.8\nPr 2", "principled 0.8 1 0 0 1.5 0 0 0 0 0 0 1", "Pr 2: expected"},
      {"map_Pr t.ppm\nmap_Pm t.ppm\nmap_Ps t.ppm", "principled 0.5 1* 1* 0 1.5 0 0 1* 0 0 0 1"},
      {"Pr 0.5\nmap_Pr t.ppm\nPm 0.3\nmap_Pm t.ppm",
       "principled 0.5 0.5* 0.3* 0 1.5 0 0 0 0 0 0 1"},
      {"map_roughness t.ppm\nmap_metallic t.ppm", "principled 0.5 1* 1* 0 1.5 0 0 0 0 0 0 1"},
      {"map_Pr no.ppm", "principled 0.5 0.5 0 0 1.5 0 0 0 0 0 0 1", "the number alone is used"},
      {"map_Pm no.ppm", "principled 0.5 0.5 0 0 1.5 0 0 0 0 0 0 1", "the number alone is used"},
      {"Kd 0.8 0.8 0.8\nPr 1\nmap_Ps no.ppm", "principled 0.8 1 0 0 1.5 0 0 0 0 0 0 1",
       "the number alone is used"},
      {"Kd 0.8 0.8 0.8\nPr 1\nPs 0.25\nmap_Ps no.ppm", "principled 0.8 1 0 0 1.5 0 0 0.25 0 0 0 1",
       "the number alone is used"},
      {"Kd 0.8 0.8 0.8\nPr 0.5\nPm 1\nKs 0.5 0.5 0.5\nmap_Ks t.ppm",
       "principled 0.8 0.5 1 0 1.5 0 0 0 0 0 0 1", "map_Ks of a metal is ignored"},
  });
}

TEST(Mtl, Bumps) {
  expect_materials({
      {"Kd 1 1 1\nmap_Bump t.ppm", "bump 1,0,0* (diffuse 1)"},
      {"Kd 1 1 1\nbump -bm 0.3 t.ppm", "bump 0.3,0,0* (diffuse 1)"},
      {"Kd 1 1 1\nbump t.ppm -bm 0.3 -mm 7 0.5", "bump 0.15,0,0* (diffuse 1)"},
      {"Kd 1 1 1\nbump no.ppm", "diffuse 1", "the surface is smooth"},
      {"Kd 1 1 1\nnorm t.ppm", "normals 1,0,0* (diffuse 1)"},
      {"Kd 1 1 1\nnorm no.ppm", "diffuse 1", "the surface is smooth"},
      {"Kd 1 1 1\nnorm t.ppm\nmap_Bump t.ppm", "normals 1,0,0* (diffuse 1)"},
      {"Kd 1 1 1\nd 0.5\nKe 1 1 1\nbump t.ppm", "bump 1,0,0* (diffuse 1) emits 1 opacity 0.5"},
      {"Kd 1 1 1\ndisp t.ppm", "diffuse 1", "disp has no counterpart"},
      {"Kd 1 1 1\nrefl -type sphere t.ppm", "diffuse 1", "refl has no counterpart"},
      {"Kd 1 1 1\nmap_Ns t.ppm", "diffuse 1", "map_Ns has no counterpart"},
      {"Kd 1 1 1\nfoo t.ppm", "diffuse 1", "line 3: material 'm': unknown statement 'foo'"},
  });
  const ObjFolder folder;  // a blue map of heights is one of normals
  folder.write("blue.ppm", "P6 1 1 255\n\x80\x80\xff");
  folder.write("height.ppm", "P6 1 1 255\n\x80\x80\x80");
  const auto text = [&](const std::string& statements) {
    const LoadedObj file = folder.load_m("Kd 1 1 1\n" + statements);
    return text_of(file.scene, file.material("m"));
  };
  EXPECT_EQ(text("bump -bm 0.5 blue.ppm"), "normals 0.5,0,0* (diffuse 1)");
  EXPECT_EQ(text("bump -imfchan l blue.ppm"), "bump 1,0,0* (diffuse 1)");
  EXPECT_EQ(text("bump height.ppm\nnorm blue.ppm"), "normals 1,0,0* (bump 1,0,0* (diffuse 1))");
}

TEST(Mtl, MaterialsAndTheirNames) {
  const ObjFolder folder;
  folder.write("a.mtl",
               "Kd 1 0 0\nnewmtl red wine\nKd 1 0 0\nnewmtl unused\nmap_Kd no.png\r\n\tnewmtl  "
               "Material #25\nKd 0 0 1\nnewmtl red wine\nKd 0 1 0\nnewmtl\nKd 1 1 1\n");
  const LoadedObj file = folder.load(
      "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl red wine\nf 1 2 3\nf 3 2 1\n"
      "usemtl Material #25\nf 1 2 3\nusemtl \"red wine\"\nf 2 1 3\nusemtl nobody\nf 1 2 3\n");
  EXPECT_EQ(text_of(file.scene, file.material("red wine")), "diffuse 0,1,0");
  EXPECT_EQ(text_of(file.scene, file.material("Material #25")), "diffuse 0,0,1");
  ASSERT_EQ(file.scene.meshes.size(), 3u);
  std::vector<std::size_t> triangles;
  for (const Mesh& mesh : file.scene.meshes) triangles.push_back(mesh.triangles.size());
  EXPECT_EQ(triangles, (std::vector<std::size_t>{2, 3, 1}));  // grey, red wine, #25
  EXPECT_EQ(file.warnings.size(), 4u);
  EXPECT_EQ(file.count("a.mtl: line 1: a statement before newmtl is ignored"), 1);
  EXPECT_EQ(file.count("material 'red wine': defined twice: the last one is used"), 1);
  EXPECT_EQ(file.count("newmtl without a name"), 1);
  EXPECT_EQ(file.count("a.obj: line 13: material 'nobody' is not defined: grey is used"), 1);
}

TEST(Mtl, OneWarningOfAKind) {
  const ObjFolder folder;
  std::string mtl, obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < 20000; ++i) {
    mtl += fmt::format("newmtl m{0}\nmap_Kd no{0}.png\nfoo{0} 1\nKd 7 0 0\n", i);
    obj += fmt::format("usemtl m{0}\nf 1 2 3\nusemtl n{0}\nf 1 2 3\nf 1 2\nf 1 2 9\n", i);
  }
  folder.write("a.mtl", mtl);
  const LoadedObj file = folder.load(obj);
  EXPECT_EQ(file.scene.meshes.size(), 20001u);
  EXPECT_EQ(file.warnings.size(), 6u);
  for (const std::string& warning : file.warnings) EXPECT_LT(warning.size(), 400u) << warning;
  EXPECT_EQ(file.count("map_Kd 'no0.png': no such file: Kd alone is used (and 19999 more, also "
                       "'no1.png', 'no2.png'"),
            1);
}

}  // namespace
}  // namespace pt
