// A scene's hash is that of all files that it was read from, whatever their format and place.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "common/error/error.h"
#include "common/scene/load/files/scene_files.h"
#include "common/scene/load/load_scene.h"
#include "temp_folder.h"

namespace pt {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

const char* const scene_text = R"(<scene version="3.0.0"><include filename="more/lights.xml"/>
  <shape type="obj"><string name="filename" value="more/mesh.obj"/>
    <bsdf type="diffuse"><texture name="reflectance" type="bitmap">
      <string name="filename" value="map.ppm"/></texture></bsdf></shape>
  <shape type="ply"><string name="filename" value="more/mesh.ply"/>
    <bsdf type="diffuse"><spectrum name="reflectance" filename="grey.spd"/></bsdf></shape></scene>)";

void write_scene(const fs::path& folder) {
  write(folder / "scene.xml", scene_text);
  write(folder / "more/lights.xml", R"(<scene version="3.0.0"><emitter type="constant"/></scene>)");
  write(folder / "more/mesh.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write(folder / "more/a.mtl", "newmtl a\nKd 1 0 0\n");
  write(
      folder / "more/mesh.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 "
      "0\n3 0 1 2\n");
  write(folder / "map.ppm", std::string("P6\n1 1\n255\n") + "abc");
  write(folder / "grey.spd", "400 0.5\n700 0.5\n");
  write(folder / "unused.txt", "x");
}

struct Read {
  std::string hash;
  std::vector<fs::path> paths;
};

Read read(const fs::path& scene) {
  const SceneFiles files;
  load_scene_file(scene);
  return {files.hash(scene.parent_path()), files.paths()};
}

TEST(SceneFiles, HashAllFilesOfAMitsubaScene) {
  const TempFolder folder;
  const fs::path a = folder.file("a"), b = folder.file("b");
  write_scene(a), write_scene(b / "c");
  const Read whole = read(a / "scene.xml");
  EXPECT_EQ(whole.hash.size(), 32u);
  EXPECT_EQ(read(a / "scene.xml").hash, whole.hash);
  EXPECT_EQ(read(b / "c" / "scene.xml").hash, whole.hash) << "the folder does not matter";
  const fs::path before = fs::current_path();
  fs::current_path(a);
  EXPECT_EQ(read("scene.xml").hash, whole.hash);
  fs::current_path(before);
  std::set<std::string> names;
  for (const fs::path& path : whole.paths) names.insert(path.lexically_relative(a).string());
  EXPECT_EQ(names, (std::set<std::string>{"scene.xml", "more/lights.xml", "more/mesh.obj",
                                          "more/mesh.ply", "map.ppm", "grey.spd"}));
  // Any byte of any of them matters; a file that is not read does not.
  for (const std::string& name : names) {
    std::ifstream stream(a / name, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    write(a / name, bytes + " ");
    EXPECT_NE(read(a / "scene.xml").hash, whole.hash) << name;
    write(a / name, bytes);
  }
  write(a / "unused.txt", "y");
  EXPECT_EQ(read(a / "scene.xml").hash, whole.hash);
}

TEST(SceneFiles, ArePackedForOthers) {
  const TempFolder folder;
  const fs::path a = folder.file("a"), root = folder.file("root");
  write_scene(a);
  const Read whole = read(a / "scene.xml");
  const std::string packed = pack_files(whole.paths);
  fs::remove_all(a);
  unpack_files(packed, root);
  const Read again = read(root / a.relative_path() / "scene.xml");
  EXPECT_EQ(again.hash, whole.hash);
  EXPECT_EQ(again.paths.size(), whole.paths.size());
  for (std::size_t length = 0; length < packed.size(); length += 1 + length / 50) {
    EXPECT_THROW(unpack_files(packed.substr(0, length), folder.file("r2")), Error) << length;
  }
  EXPECT_THROW(unpack_files(packed + "x", folder.file("r2")), Error);
  EXPECT_THROW(pack_files({folder.file("nothing")}), Error);
}

TEST(SceneFiles, AFileOutsideOfTheRootIsRefused) {
  const TempFolder folder;
  write(folder.file("a"), "x");
  std::string packed = pack_files({folder.file("a")});
  const std::string name = folder.file("a");
  std::string bad = "../" + std::string(name.size() - 3, 'b');
  packed.replace(packed.find(name), name.size(), bad);
  EXPECT_THROW(unpack_files(packed, folder.file("root")), Error);
}

}  // namespace
}  // namespace pt
