// A byte order mark, which editors on Windows write, is no part of a text.
#include <gtest/gtest.h>

#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/load_scene.h"
#include "load/gltf_files.h"
#include "load/obj_files.h"
#include "temp_folder.h"

namespace pt {
namespace {

const std::string mark = "\xef\xbb\xbf";
const std::string triangle = "v 3 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

TEST(ByteOrderMark, IsSkippedInObj) {
  const Mesh mesh = decode_obj(mark + triangle, "a.obj");
  ASSERT_EQ(mesh.positions.size(), 3u);
  EXPECT_EQ(mesh.positions[0], Vec3(3, 0, 0));
}

TEST(ByteOrderMark, IsSkippedInMtl) {
  const TempFolder folder;
  write_text(folder.file("a.mtl"), mark + "newmtl red\nKd 1 0 0\n");
  write_text(folder.file("a.obj"), mark + "mtllib a.mtl\nusemtl red\n" + triangle);
  const LoadedObj file(folder.file("a.obj"));
  EXPECT_TRUE(file.warnings.empty());
  EXPECT_EQ(file.material("red").color(0), Color(1, 0, 0));
}

TEST(ByteOrderMark, IsSkippedInPly) {
  const Mesh mesh =
      decode_ply(mark +
                     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                     "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                     "end_header\n3 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
                 "a.ply");
  ASSERT_EQ(mesh.positions.size(), 3u);
  EXPECT_EQ(mesh.positions[0], Vec3(3, 0, 0));
}

TEST(ByteOrderMark, IsSkippedInXml) {
  const TempFolder folder;
  write_text(folder.file("a.obj"), triangle);
  write_text(folder.file("scene.xml"),
             mark +
                 "<scene version=\"3.0.0\"><shape type=\"obj\">"
                 "<string name=\"filename\" value=\"a.obj\"/></shape></scene>");
  EXPECT_EQ(load_mitsuba_xml(folder.file("scene.xml"), {}).meshes.size(), 1u);
}

TEST(ByteOrderMark, IsSkippedInGltf) {
  EXPECT_EQ(Loaded(mark + triangle_file().gltf()).scene.meshes.size(), 1u);
}

}  // namespace
}  // namespace pt
