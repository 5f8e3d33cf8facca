// Pictures and libraries: options of maps, names as exporters write them, what is missing.
#include "load/expect_near.h"
#include "load/obj_files.h"

namespace pt {
namespace {

const Color red(1, 0, 0), green(0, 1, 0), blue(0, 0, 1), white(1, 1, 1);

struct MapCase {
  std::string map;  ///< behind map_Kd
  Vec2 uv;
  Color expected;
  std::string warning = {};
};

void expect_maps(const std::vector<MapCase>& cases, const std::string& statement = "map_Kd ") {
  const ObjFolder folder;
  for (const char* name : {"t.ppm", "my tex.ppm", "sub/s.ppm", "-odd.ppm"}) {
    folder.write(name, four_colors);
  }
  for (const MapCase& c : cases) {
    const LoadedObj file = folder.load_m("illum 1\n" + statement + c.map);
    const MaterialDescription& m = file.material("m");
    const std::uint32_t texture =
        statement == "map_Ke " ? m.emission.texture : m.parameters[0].texture;
    EXPECT_EQ(texture == no_texture, c.expected == Color(-1)) << c.map;
    if (texture != no_texture) {
      SCOPED_TRACE(c.map);
      expect_near(file.texture_at(texture, c.uv), c.expected);
    }
    EXPECT_EQ(file.warnings.size(), c.warning.empty() ? 0u : 1u) << c.map;
    for (const std::string& warning : file.warnings) {
      EXPECT_NE(warning.find(c.warning), std::string::npos) << c.map << warning;
    }
  }
}

// Maps of 2 x 2 texels, whose centres lie at a quarter and three quarters.
TEST(MtlMaps, Options) {
  expect_maps({
      {"t.ppm", {0.25f, 0.75f}, red},
      {"t.ppm", {0.75f, 0.75f}, green},
      {"t.ppm", {0.25f, 0.25f}, blue},
      {"t.ppm", {0.75f, 0.25f}, white},
      {"t.ppm", {1.25f, 0.25f}, blue},
      {"-o 0.5 0 0 t.ppm", {0.25f, 0.25f}, white},
      {"-o 0.5 t.ppm", {0.25f, 0.25f}, white},
      {"-o 0 0.5 t.ppm", {0.25f, 0.25f}, red},
      {"-o 0 0.25 t.ppm", {0.25f, 0.5f}, red},
      {"-s 1 -1 1 t.ppm", {0.25f, 0.25f}, red},
      {"-s -1 t.ppm", {0.25f, 0.25f}, white},
      {"-s 2 2 1 t.ppm", {0.375f, 0.125f}, white},
      {"-s 2 1 1 -o 0.25 0 0 t.ppm", {0.25f, 0.25f}, white},  // scaled, then moved
      {"-clamp on t.ppm", {1.25f, 0.25f}, white},
      {"-clamp on t.ppm", {0.25f, 1.25f}, red},
      {"-clamp off t.ppm", {1.25f, 0.25f}, blue},
      {"-clamp maybe t.ppm", {1.25f, 0.25f}, blue, "-clamp: expected on or off, found 'maybe'"},
      {"-mm 0 0.5 t.ppm", {0.25f, 0.75f}, {0.5f, 0, 0}},
      {"-mm 0.25 0.5 t.ppm", {0.25f, 0.75f}, {0.75f, 0.25f, 0.25f}},
      {"-mm -0.5 2 t.ppm", {0.25f, 0.75f}, red},
      {"-mm 0.5 t.ppm", {0.25f, 0.75f}, red, "-mm: expected 2 numbers, found 't.ppm'"},
      {"t.ppm", {0.49f, 0.25f}, {0.48f, 0.48f, 1}},
      {"-blendu off -blendv off t.ppm", {0.49f, 0.25f}, blue},
      {"-blendu off t.ppm", {0.49f, 0.25f}, {0.48f, 0.48f, 1}, "-blendu and -blendv differ"},
      {"-blendu on -texres 512 -bm 3 -cc off -t 0 0 0 t.ppm", {0.25f, 0.75f}, red},
      {"-t 1 1 1 t.ppm", {0.25f, 0.75f}, red, "map_Kd: -t has no counterpart"},
      {"-cc on t.ppm", {0.25f, 0.75f}, red, "map_Kd: -cc has no counterpart"},
      {"-boost 2 t.ppm", {0.25f, 0.75f}, red, "map_Kd: -boost has no counterpart"},
      {"-type sphere t.ppm", {0.25f, 0.75f}, red, "map_Kd: -type has no counterpart"},
      {"-imfchan r t.ppm", {0.25f, 0.75f}, red},
      {"-imfchan z t.ppm", {0.25f, 0.75f}, red, "expected r, g, b, m or l, found 'z'"},
      {"-new 3 4 t.ppm", {0.25f, 0.75f}, red, "unknown option '-new'"},
      {"-O 0.5 0 0 t.ppm", {0.25f, 0.25f}, white},
      // Behind the name, as some exporters write them.
      {"t.ppm -o 0.5 0 0 -bm 1", {0.25f, 0.25f}, white},
      {"-s 1 -1 t.ppm -o 0.5 0 0", {0.25f, 0.25f}, green},
      {"t.ppm -bm 1 rest", {0.25f, 0.75f}, red, "'rest' behind the name of a picture"},
      {"my tex.ppm", {0.25f, 0.75f}, red},
      {"my tex.ppm -o 0.5 0 0", {0.25f, 0.25f}, white},
      {"\"my tex.ppm\"", {0.25f, 0.75f}, red},
      {"-o 0.5 0 0 \"my tex.ppm\" -bm 1", {0.25f, 0.25f}, white},
      {"\"my tex.ppm", {0.25f, 0.75f}, red},
      {"-odd.ppm", {0.25f, 0.75f}, red},
      {"-o 0.5 0 0", {0, 0}, Color(-1), "map_Kd: expected the name of a picture"},
  });
  // What is emitted has no upper bound.
  expect_maps({{"-mm 1 2 t.ppm", {0.25f, 0.75f}, {3, 1, 1}}}, "map_Ke ");
}

TEST(MtlMaps, OnePictureWithSeveralGains) {
  const ObjFolder folder;
  folder.write("t.ppm", four_colors);
  const LoadedObj file = folder.load_m("map_Kd -mm 0 0.5 t.ppm\nmap_Ke -mm 0 0.25 t.ppm\n");
  const MaterialDescription& m = file.material("m");
  expect_near(file.texture_at(m.parameters[0].texture, {0.25f, 0.75f}), {0.5f, 0, 0});
  expect_near(file.texture_at(m.emission.texture, {0.25f, 0.75f}), {0.25f, 0, 0});
}

TEST(MtlMaps, NamesOfOtherSystemsAndMachines) {
  const std::string elsewhere = "does not exist: ";
  expect_maps({
      {"sub\\s.ppm", {0.25f, 0.75f}, red},
      {".\\sub\\s.ppm", {0.25f, 0.75f}, red},
      {"sub//s.ppm", {0.25f, 0.75f}, red},
      {"sub\\\\s.ppm", {0.25f, 0.75f}, red},
      {"SUB\\S.PPM", {0.25f, 0.75f}, red, "whose case differs"},
      {"C:\\\\Users\\\\someone\\\\t.ppm", {0.25f, 0.75f}, red, elsewhere},
      {"C:\\Users\\some one\\my tex.ppm", {0.25f, 0.75f}, red, elsewhere},
      {"C:/Users/someone/sub/s.ppm", {0.25f, 0.75f}, red, elsewhere},
      {"/home/someone/sub/s.ppm", {0.25f, 0.75f}, red, elsewhere},
      {"/t.ppm", {0.25f, 0.75f}, red, elsewhere},
      {"C:t.ppm", {0.25f, 0.75f}, red, elsewhere},
      {"\\t.ppm", {0.25f, 0.75f}, red, elsewhere},
      {"\\\\server\\share\\t.ppm", {0.25f, 0.75f}, red, elsewhere},
      {"..\\textures\\t.ppm", {0.25f, 0.75f}, red, elsewhere},
      {"textures/t.ppm", {0.25f, 0.75f}, red, elsewhere},
      {"sub", {0, 0}, Color(-1), "map_Kd 'sub': no such file"},
      {"C:", {0, 0}, Color(-1), "map_Kd 'C:': no such file"},
      {"..", {0, 0}, Color(-1), "map_Kd '..': no such file"},
      {std::string(100000, 'x'), {0, 0}, Color(-1), "xxx...': no such file"},
  });
  const ObjFolder folder, other;
  other.write("t.ppm", four_colors);  // an absolute path that exists
  const LoadedObj file = folder.load_m("map_Kd " + other.file("t.ppm"));
  EXPECT_NE(file.material("m").parameters[0].texture, no_texture);
  EXPECT_TRUE(file.warnings.empty());
}

TEST(MtlMaps, BrokenPicturesAreReadOnceAndWarnedOf) {
  const ObjFolder folder;
  folder.write("broken.png", "\x89PNG\r\n\x1a\n");
  folder.write("a.mtl",
               "newmtl m\nmap_Kd broken.png\nKd 0.25 0.5 1\nnewmtl n\nmap_Kd broken.png\n");
  const LoadedObj file = folder.load(triangle_of_m + "usemtl n\nf 1 2 3\n");
  EXPECT_EQ(text_of(file.scene, file.material("m")), "diffuse 0.25,0.5,1");
  EXPECT_EQ(text_of(file.scene, file.material("n")), "diffuse 0.5");
  ASSERT_EQ(file.warnings.size(), 1u);
  EXPECT_EQ(file.count("broken.png"), 1);
  EXPECT_EQ(file.count("(and 1 more)"), 1);
}

/// A TGA of one texel.
std::string tga(char r, char g, char b, char a) {
  const char header[] = {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 32, 8};
  return std::string(header, sizeof(header)) + std::string{b, g, r, a};
}

// Alpha where there is one, unless the file names a channel; bytes are linear.
TEST(MtlMaps, OpacityAndNumbersByChannel) {
  const ObjFolder folder;
  const char half = static_cast<char>(51);  // 0.2
  folder.write("rgba.tga", tga('\xff', 0, '\xff', half));
  folder.write("rgb.tga", tga('\xff', 0, half, '\xff'));
  const auto opacity = [&](const std::string& map) {
    const LoadedObj file = folder.load_m("Kd 1 1 1\nmap_d " + map);
    const Opacity& o = file.material("m").opacity;
    return o.is_constant() ? o.offset
                           : o.offset + o.scale * grey_of(file.texture_at(o.texture, {}));
  };
  EXPECT_NEAR(opacity("rgba.tga"), 0.2, 1e-5);
  EXPECT_NEAR(opacity("-imfchan m rgba.tga"), 0.2, 1e-5);
  EXPECT_NEAR(opacity("-imfchan r rgba.tga"), 1, 1e-5);
  EXPECT_NEAR(opacity("-imfchan g rgba.tga"), 0, 1e-5);
  EXPECT_NEAR(opacity("-imfchan l rgba.tga"), 0.212671 + 0.072169, 1e-5);
  EXPECT_NEAR(opacity("rgb.tga"), 0.212671 + 0.2 * 0.072169, 1e-5);
  EXPECT_NEAR(opacity("-imfchan b rgb.tga"), 0.2, 1e-5);
  EXPECT_NEAR(opacity("-imfchan m rgb.tga"), 1, 1e-5);
  const auto roughness = [&](const std::string& map) {
    const LoadedObj file = folder.load_m("Kd 1 1 1\nmap_Pr " + map);
    const Parameter& p = file.material("m")[&Principled::roughness];
    return p.value.x * file.texture_at(p.texture, {}).x;
  };
  EXPECT_NEAR(roughness("rgb.tga"), 0.212671 + 0.2 * 0.072169, 1e-5);
  EXPECT_NEAR(roughness("-imfchan b rgb.tga"), 0.2, 1e-5);
  EXPECT_NEAR(roughness("-imfchan b -mm 0.1 2 rgb.tga"), 0.5, 1e-5);
}

struct LibraryCase {
  std::string line;
  bool is_found;
  std::string warning = {};
};

TEST(MtlLibraries, NamesAsExportersWriteThem) {
  const ObjFolder folder;
  const std::string m = "newmtl m\nKd 0.25 0.25 0.25\n";
  for (const char* name : {"m.mtl", "my mat.mtl", "mats/sub.mtl", "plain"}) folder.write(name, m);
  folder.write("n.mtl", "newmtl n\nKd 1 0 0\n");
  const std::vector<LibraryCase> cases = {
      {"m.mtl", true},
      {"./m.mtl", true},
      {"\"m.mtl\"", true},
      {"plain", true},
      {"my mat.mtl", true},
      {"\"my mat.mtl\"", true},
      {"mats/sub.mtl", true},
      {"mats\\sub.mtl", true},
      {".\\mats\\sub.mtl", true},
      {"M.MTL", true, "whose case differs"},
      {"C:\\work\\m.mtl", true, "does not exist: "},
      {"/home/someone/mats/sub.mtl", true, "does not exist: "},
      {"n.mtl m.mtl", true},
      {"n.mtl my mat.mtl", true},
      {"my mat.mtl n.mtl", true},
      {"\"my mat.mtl\" \"n.mtl\"", true},
      {"n.mtl \"mats\\sub.mtl\"", true},
      {"n.mtl plain", true},
      {"plain n.mtl", true},
      {"no.mtl m.mtl", true, "a.obj: no.mtl: No such file or directory"},
  };
  for (const LibraryCase& c : cases) {
    const LoadedObj file =
        folder.load("mtllib " + c.line + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
    EXPECT_EQ(text_of(file.scene, file.material("m")), "diffuse 0.25") << c.line;
    EXPECT_EQ(file.warnings.size(), c.warning.empty() ? 0u : 1u) << c.line;
    if (!c.warning.empty()) {
      EXPECT_EQ(file.count(c.warning), 1) << c.line;
    }
  }
}

TEST(MtlLibraries, TheFirstThatDefinesAMaterialCounts) {
  const ObjFolder folder;
  folder.write("1.mtl", "newmtl m\nKd 1 0 0\n");
  folder.write("2.mtl", "newmtl m\nKd 0 1 0\nnewmtl n\nKd 0 0 1\n");
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (const char* lines : {"mtllib 1.mtl 2.mtl\n", "mtllib 1.mtl\nmtllib 2.mtl\nmtllib 1.mtl\n"}) {
    const LoadedObj file = folder.load(lines + points + "usemtl m\nf 1 2 3\nusemtl n\nf 1 2 3\n");
    EXPECT_EQ(text_of(file.scene, file.material("m")), "diffuse 1,0,0");
    EXPECT_EQ(text_of(file.scene, file.material("n")), "diffuse 0,0,1");
    EXPECT_TRUE(file.warnings.empty());
  }
  // A library may be named behind its use, and in a continued line.
  const LoadedObj late = folder.load(points + "usemtl n\nf 1 2 3\n mtllib 2.mtl\n");
  EXPECT_EQ(text_of(late.scene, late.material("n")), "diffuse 0,0,1");
  const LoadedObj continued =
      folder.load("mtllib 1.mtl \\\n2.mtl\n" + points + "usemtl n\nf 1 2 3\n# mtllib no.mtl\n");
  EXPECT_EQ(text_of(continued.scene, continued.material("n")), "diffuse 0,0,1");
  EXPECT_TRUE(continued.warnings.empty());
}

TEST(MtlLibraries, WhatIsMissing) {
  const ObjFolder folder;
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
  const LoadedObj none = folder.load("mtllib no.mtl\n" + triangle);
  EXPECT_EQ(none.warnings.size(), 2u);
  EXPECT_EQ(none.count("a.obj: no.mtl: No such file or directory"), 1);
  EXPECT_EQ(none.count("a.obj: line 5: material 'm' is not defined: grey is used"), 1);
  EXPECT_EQ(text_of(none.scene, none.scene.materials.at(none.scene.meshes.at(0).material)),
            "diffuse 0.5");
  folder.write("a.mtl", "newmtl m\nKd 1 0 0\n");
  const LoadedObj beside = folder.load("mtllib no.mtl\n" + triangle);
  EXPECT_EQ(beside.warnings.size(), 1u);
  EXPECT_EQ(beside.count("no.mtl: No such file or directory: a.mtl is used"), 1);
  EXPECT_EQ(text_of(beside.scene, beside.material("m")), "diffuse 1,0,0");
  LoadOptions strict;
  strict.strict = true;
  expect_error([&] { load_obj(folder.file("a.obj"), strict); }, "(--strict)");
  const LoadedObj device = folder.load("mtllib /dev/null\n" + triangle);
  EXPECT_EQ(device.count("/dev/null: not a regular file"), 1);
}

// Pictures lie beside the MTL file, or else beside the OBJ file.
TEST(MtlLibraries, PicturesBesideEitherFile) {
  const ObjFolder folder;
  folder.write("mats/a.mtl", "newmtl m\nmap_Kd 1.ppm\nmap_Ke 2.ppm\n");
  folder.write("mats/1.ppm", four_colors);
  folder.write("2.ppm", four_colors);
  const LoadedObj file =
      folder.load("mtllib mats/a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
  EXPECT_EQ(text_of(file.scene, file.material("m")), "diffuse 1* emits 1*");
  EXPECT_TRUE(file.warnings.empty());
}

// Each library is read once, and messages stay short.
TEST(MtlLibraries, ManyLinesAndLongNames) {
  const ObjFolder folder;
  std::string mtl, lines;
  for (int i = 0; i < 5000; ++i) {
    mtl += fmt::format("newmtl m{}\nKd 1 0 0\n", i);
    lines += i % 2 ? "mtllib a.mtl\n" : fmt::format("mtllib {}a.mtl\n", std::string(i, '.') + "/");
    lines += fmt::format("mtllib no{}.mtl\n", i);
  }
  folder.write("a.mtl", mtl);
  const std::string long_name(5 << 20, 'y');
  const LoadedObj file =
      folder.load(lines + "mtllib " + long_name +
                  "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m4999\nf 1 2 3\nusemtl " + long_name +
                  "\nf 1 2 3\nv " + long_name + "\nf " + long_name + "\n");
  EXPECT_EQ(text_of(file.scene, file.material("m4999")), "diffuse 1,0,0");
  for (const std::string& warning : file.warnings) EXPECT_LT(warning.size(), 1000u);
}

// The last parts of a foreign path lead to nothing above the scene's folder.
TEST(MtlMaps, LastPartsDoNotBeginAbove) {
  const ObjFolder folder;
  folder.write("t.ppm", std::string("P6 1 1 255\n\0\xff\0", 14));
  folder.write("scene/t.ppm", four_colors);
  folder.write("scene/a.obj", triangle_of_m);
  for (const std::string name : {"C:\\..\\t.ppm", "C:\\x\\..\\..\\t.ppm", "/x/y/../../../t.ppm"}) {
    SCOPED_TRACE(name);
    folder.write("scene/a.mtl", "newmtl m\nmap_Kd " + name + "\n");
    const LoadedObj file(folder.file("scene/a.obj"));
    expect_near(file.texture_at(file.material("m").parameters[0].texture, {0.25f, 0.75f}), red);
    EXPECT_EQ(file.count("does not exist: "), 1);
  }
}

// Maps of one picture that differ in any option show what each shows alone.
TEST(MtlMaps, ScaledPicturesDifferByEveryOption) {
  const std::string maps[] = {"map_Kd -mm 0 0.5",
                              "map_Kd -mm 0.25 0.5",
                              "map_Kd -mm 0 2",
                              "map_Ke -mm 0 2",
                              "map_Kd -mm 0 0.5 -o 0.5",
                              "map_Kd -mm 0 0.5 -o 0 0.5",
                              "map_Kd -mm 0 0.5 -s 2",
                              "map_Kd -mm 0 0.5 -s 1 2",
                              "map_Kd -mm 0 0.5 -clamp on",
                              "map_Kd -mm 0 0.5 -blendu off -blendv off",
                              "map_Pr -mm 0 0.5",
                              "map_Pr -mm 0 0.5 -imfchan r",
                              "map_Pr -mm 0 0.5 -imfchan g",
                              "map_Pr -mm 0 0.5 -imfchan b"};
  const ObjFolder folder;
  folder.write("t.ppm", four_colors);
  const auto texture_of = [](const MaterialDescription& m) {
    std::uint32_t texture = m.emission.texture;
    for (const Parameter& p : m.parameters) texture = std::min(texture, p.texture);
    EXPECT_NE(texture, no_texture);
    return texture;
  };
  std::string library, triangles = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (std::size_t i = 0; i < std::size(maps); ++i) {
    library += fmt::format("newmtl m{}\n{} t.ppm\n", i, maps[i]);
    triangles += fmt::format("usemtl m{}\nf 1 2 3\n", i);
  }
  folder.write("a.mtl", library);
  const LoadedObj together = folder.load(triangles);
  for (std::size_t i = 0; i < std::size(maps); ++i) {
    SCOPED_TRACE(maps[i]);
    const LoadedObj alone = folder.load_m(maps[i] + " t.ppm\n");
    for (const Vec2 uv : {Vec2(0.25f, 0.75f), Vec2(0.25f, 0.25f), Vec2(0.49f, 0.3f),
                          Vec2(1.25f, 0.25f), Vec2(0.7f, 1.3f), Vec2(0.75f, 0.75f)}) {
      expect_near(together.texture_at(texture_of(together.material(fmt::format("m{}", i))), uv),
                  alone.texture_at(texture_of(alone.material("m")), uv));
    }
  }
  EXPECT_EQ(together.scene.textures.size(), std::size(maps));
}

}  // namespace
}  // namespace pt
