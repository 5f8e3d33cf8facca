// Files whose names differ from what other files call them in case only, of all formats.
#include "common/scene/load/files/whole_file.h"
#include "load/gltf_files.h"
#include "load/obj_files.h"

namespace pt {
namespace {

struct Found {
  std::vector<std::string> warnings;
  std::string name;  ///< in the folder

  Found(const TempFolder& folder, const std::string& wanted) {
    const auto warn = [this](const std::string& line) { warnings.push_back(line); };
    const auto path = find_file(folder.file(""), wanted, warn);
    name = path.empty() ? "" : path.lexically_relative(folder.file("")).string();
  }
};

TEST(FindFile, ByCaseWhereNothingElseFits) {
  const TempFolder folder;
  std::filesystem::create_directories(folder.file("Tex"));
  std::filesystem::create_directories(folder.file("tex"));
  for (const char* name : {"a.png", "A.PNG", "Tex/wood.PNG", "tex/steel.png"}) {
    write_text(folder.file(name), "x");
  }
  const Found same(folder, "a.png");
  EXPECT_EQ(same.name, "a.png");
  EXPECT_TRUE(same.warnings.empty());
  const Found other(folder, "a.PNG");
  EXPECT_EQ(other.name, "A.PNG") << "the first in alphabetical order";
  ASSERT_EQ(other.warnings.size(), 1u);
  EXPECT_NE(other.warnings[0].find("'a.PNG' does not exist: "), std::string::npos);
  EXPECT_EQ(Found(folder, "Tex/STEEL.png").name, "tex/steel.png") << "the other folder has it";
  EXPECT_EQ(Found(folder, "TEX/../tEx/./Wood.png").name, "Tex/wood.PNG");
  EXPECT_EQ(Found(folder, "b.png").name, "");
  EXPECT_TRUE(Found(folder, "b.png").warnings.empty());
}

// 2^30 ways lead to the folder itself.
TEST(FindFile, LinksThatLeadBackAreFollowedOnce) {
  const TempFolder folder;
  for (const char* name : {"a", "A"})
    std::filesystem::create_directory_symlink(".", folder.file(name));
  std::filesystem::create_directories(folder.file("b/C"));
  write_text(folder.file("b/C/x.ply"), "x");
  std::filesystem::create_directory_symlink("..", folder.file("b/a"));
  std::string name;
  for (int i = 0; i < 30; ++i) name += "a/";
  EXPECT_EQ(Found(folder, name + "x.ply").name, "");
  EXPECT_EQ(Found(folder, name + "B/a/B/c/X.ply").name, name + "b/a/b/C/x.ply");
  std::filesystem::create_symlink("loop", folder.file("loop"));
  EXPECT_EQ(Found(folder, "LOOP").name, "loop") << "it is there; reading it fails";
  EXPECT_EQ(Found(folder, "loop/x").name, "");
}

TEST(FindFile, BuffersAndImagesOfGltf) {
  const TempFolder folder;
  GltfMaker maker = with_material(
      {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorTexture", {{"index", 0}}}}}});
  maker.root["textures"] = {{{"source", 0}}};
  maker.root["images"] = {{{"uri", "Grey.pgm"}}};
  write_text(folder.file("Scene.BIN"), maker.buffer);
  write_text(folder.file("grey.PGM"), "P5 1 1 255\nx");
  write_text(folder.file("scene.gltf"), maker.with_buffer("scene.bin").dump());
  std::vector<std::string> messages;
  LoadOptions options;
  options.warn = [&](const std::string& message) { messages.push_back(message); };
  const SceneData scene = load_gltf(folder.file("scene.gltf"), options);
  EXPECT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(std::ranges::count_if(messages,
                                  [](auto& m) { return m.find("whose case differs") != m.npos; }),
            2);
}

TEST(FindFile, MaterialsAndMapsOfObj) {
  const TempFolder folder;
  write_text(folder.file("One.MTL"), "newmtl m\nmap_Kd Wood.png\n");
  write_text(folder.file("WOOD.PNG"), "P5 1 1 255\nx");
  write_text(folder.file("one.obj"),
             "mtllib one.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const LoadedObj file(folder.file("one.obj"));
  EXPECT_EQ(file.scene.textures.size(), 1u);
  ASSERT_EQ(file.warnings.size(), 1u);
  EXPECT_EQ(file.count("One.MTL, whose case differs, is used (and 1 more, also 'Wood.png')"), 1);
}

}  // namespace
}  // namespace pt
