// Scene files by their endings, and what a viewer needs that they do not say.
#include "common/scene/data/scene_data.h"
#include "common/scene/load/load_scene.h"
#include "load/expect_near.h"
#include "load/gltf_files.h"
#include "shared_file.h"

namespace pt {
namespace {

constexpr const char* ply_text =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n2 0 0\n2 4 0\n0 4 0\n4 0 1 2 3\n";

struct LoadedFile {
  std::vector<std::string> messages;
  SceneData scene;

  LoadedFile(const std::string& path) {
    LoadOptions options;
    options.warn = [this](const std::string& message) { messages.push_back(message); };
    scene = load_scene_file(path, options);
  }
};

TEST(LoadScene, PlyIsGreyInAStudio) {
  TempFolder folder;
  write_text(folder.file("quad.PLY"), ply_text);
  const LoadedFile file(folder.file("quad.PLY"));
  EXPECT_EQ(file.scene.name, "quad.PLY");
  ASSERT_EQ(file.scene.meshes.size(), 1u);
  EXPECT_EQ(file.scene.meshes[0].triangles.size(), 2u);
  const MaterialDescription& material = file.scene.materials.at(file.scene.meshes[0].material);
  EXPECT_EQ(material.kind, kind_of<Diffuse>);
  EXPECT_EQ(material.color(0), Color(0.5f));
  EXPECT_GT(file.scene.environment.width, 0);
  expect_near(file.scene.camera.look_at, {1, 2, 0});
  EXPECT_GT(file.scene.camera.look_from.z, 2.0f);
  EXPECT_EQ(file.messages.size(), 1u);
}

TEST(LoadScene, ObjHasTheMaterialsOfItsMtl) {
  TempFolder folder;
  write_text(folder.file("red.mtl"), "newmtl red\nKd 0.9 0.1 0.2\n");
  write_text(folder.file("one.obj"),
             "mtllib red.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n");
  const LoadedFile file(folder.file("one.obj"));
  ASSERT_EQ(file.scene.meshes.size(), 1u);
  expect_near(file.scene.materials.at(file.scene.meshes[0].material).color(0), {0.9f, 0.1f, 0.2f});
  EXPECT_GT(file.scene.environment.width, 0);
}

TEST(LoadScene, ObjThatEmitsNeedsNoSky) {
  TempFolder folder;
  write_text(folder.file("lamp.mtl"), "newmtl lamp\nKd 0 0 0\nKe 3 2 1\n");
  write_text(folder.file("lamp.obj"),
             "mtllib lamp.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl lamp\nf 1 2 3\n");
  const LoadedFile file(folder.file("lamp.obj"));
  expect_near(file.scene.materials.at(file.scene.meshes.at(0).material).emission.radiance,
              {3, 2, 1});
  EXPECT_TRUE(is_black(file.scene.sky.zenith));
  EXPECT_EQ(file.scene.environment.width, 0);
}

TEST(LoadScene, GltfInBothForms) {
  TempFolder folder;
  write_text(folder.file("a.gltf"), triangle_file().gltf());
  write_text(folder.file("a.glb"), triangle_file().glb());
  EXPECT_EQ(load_scene_file(folder.file("a.gltf")).meshes.size(), 1u);
  EXPECT_EQ(load_scene_file(folder.file("a.glb")).meshes.size(), 1u);
}

TEST(LoadScene, XmlIsMitsubas) {
  TempFolder folder;
  write_text(folder.file("a.xml"),
             "<scene version='3.0.0'><shape type='sphere'><float name='radius' value='2'/>"
             "</shape></scene>");
  EXPECT_EQ(load_scene_file(folder.file("a.xml")).spheres.size(), 1u);
}

TEST(LoadScene, UnknownEndingsGetTheList) {
  expect_error([] { load_scene_file("scene.blend"); },
               "scene.blend: unknown kind of scene file '.blend'; expected one of .xml, .gltf, "
               ".glb, .pbrt, .obj, .ply");
  expect_error([] { load_scene_file("scene"); }, "scene: unknown");
  TempFolder folder;
  write_text(folder.file("empty.ply"),
             "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
             "property float z\nelement face 0\nproperty list uchar int vertex_indices\n"
             "end_header\n");
  expect_error([&] { load_scene_file(folder.file("empty.ply")); }, "empty.ply: no triangles");
}

}  // namespace
}  // namespace pt
