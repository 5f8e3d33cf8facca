// Mitsuba's .serialized, written here by zlib. Mitsuba 3.9.1 reads files of this layout, both
// versions and precisions, as these tests expect.
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>

#include "common/scene/load/files/meshes/mesh_files.h"
#include "load/mesh_bytes.h"
#include "load/mitsuba_scene.h"
#include "temp_folder.h"

namespace pt {
namespace {

struct Kind {
  int version = 4;
  bool in_double = false;
  std::uint32_t flags = 0;  ///< besides the precision
  std::uint64_t vertices = 3, triangles = 1;
  std::uint32_t last_index = 2;
  std::uint32_t float_flag = 0x1000;
};

void put_floats(MeshBytes& out, bool in_double, std::initializer_list<double> values) {
  for (const double value : values) {
    in_double ? out.put(value) : out.put(static_cast<float>(value));
  }
}

std::string compressed(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string out(size, '\0');
  EXPECT_EQ(compress(reinterpret_cast<Bytef*>(out.data()), &size,
                     reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()),
            Z_OK);
  return out.substr(0, size);
}

/// One triangle, at height z.
std::string shape(const Kind& kind, double z) {
  MeshBytes body;
  body.put<std::uint32_t>(kind.flags | (kind.in_double ? 0x2000 : kind.float_flag));
  if (kind.version == 4) body.text += std::string("a name\0", 7);
  body.put(kind.vertices).put(kind.triangles);
  put_floats(body, kind.in_double, {0, 0, z, 1, 0, z, 0, 1, z});
  if (kind.flags & 1) put_floats(body, kind.in_double, {0, 0, 2, 0, 0, 3, 0, 3, 4});
  if (kind.flags & 2) put_floats(body, kind.in_double, {0, 0.25, 1, 0, 0, 1});
  if (kind.flags & 8) put_floats(body, kind.in_double, {9, 9, 9, 9, 9, 9, 9, 9, 9});
  body.put<std::uint32_t>(0).put<std::uint32_t>(1).put<std::uint32_t>(kind.last_index);
  MeshBytes header;
  header.put<std::uint16_t>(0x041c).put(static_cast<std::uint16_t>(kind.version));
  return header.text + compressed(body.text);
}

/// Three shapes, at heights 0, 1 and 2.
std::string file_of(const Kind& kind) {
  MeshBytes file, table;
  for (int i = 0; i < 3; ++i) {
    kind.version == 4 ? table.put<std::uint64_t>(file.text.size())
                      : table.put(static_cast<std::uint32_t>(file.text.size()));
    file.text += shape(kind, i);
  }
  return file.text + table.put<std::uint32_t>(3).text;
}

TEST(Serialized, EveryKindOfShape) {
  for (const int version : {3, 4}) {
    for (const bool in_double : {false, true}) {
      for (const std::uint32_t flags : {0u, 1u, 2u, 8u, 11u, 27u}) {
        const std::string bytes = file_of({version, in_double, flags});
        for (int i = 0; i < 3; ++i) {
          const Mesh mesh = decode_serialized(bytes, "a.serialized", i);
          const auto z = static_cast<float>(i);
          EXPECT_EQ(mesh.positions, (std::vector<Vec3>{{0, 0, z}, {1, 0, z}, {0, 1, z}}));
          ASSERT_EQ(mesh.triangles.size(), 1u);
          EXPECT_EQ(mesh.triangles[0].v[2], 2u);
          ASSERT_EQ(mesh.normals.size(), flags & 1 && !(flags & 16) ? 3u : 0u);
          if (!mesh.normals.empty()) {
            EXPECT_LT(glm::length(mesh.normals[2] - Vec3(0, 0.6f, 0.8f)), 1e-6f);
          }
          ASSERT_EQ(mesh.uvs.size(), flags & 2 ? 3u : 0u);
          if (!mesh.uvs.empty()) {
            EXPECT_EQ(mesh.uvs[0], Vec2(0, 0.25f));
          }
        }
      }
    }
  }
}

TEST(Serialized, WithoutAPrecisionTheNumbersAreFloats) {
  std::vector<std::string> warnings;
  MeshFileOptions options;
  options.warnings = &warnings;
  // Flags 0x103: two files in circulation have them. 0x100 is none of the manual's.
  const std::string bytes = file_of({.flags = 0x103, .float_flag = 0});
  const Mesh mesh = decode_serialized(bytes, "a.serialized", 1, options);
  EXPECT_EQ(mesh.positions, (std::vector<Vec3>{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}));
  EXPECT_EQ(mesh.uvs.size(), 3u);
  EXPECT_EQ(warnings, std::vector<std::string>{"flags 0x103 say neither float nor double: float"});
  decode_serialized(file_of({}), "a.serialized", 1, options);
  EXPECT_EQ(warnings.size(), 1u);
}

TEST(Serialized, BrokenFilesAreRefused) {
  const TempFolder folder;
  const std::string path = folder.file("a.serialized"), good = file_of({});
  expect_error([&] { read_serialized(path, 0); }, "No such file");
  write_text(path, good);
  expect_error([&] { read_serialized(path, 3); }, "cannot read shape 3 of " + path);
  expect_error([&] { decode_serialized(good, "a.serialized", -1); }, "shape -1, expected 0 to 2");
  expect_error([&] { decode_serialized("", "a.serialized", 0); }, "truncated");
  expect_error([&] { decode_serialized("not a mesh", "a.serialized", 0); }, "wrong magic number");
  expect_error([&] { decode_serialized(file_of({.version = 5}), "a.serialized", 0); }, "version 5");
  expect_error([&] { decode_serialized(file_of({.last_index = 3}), "a.serialized", 0); },
               "triangle 0: indices 0, 1 and 3 into 3 vertices");
  // The first shape's last four bytes are its checksum; the second one begins behind them.
  std::string damaged = good;
  damaged[shape({}, 0).size() - 1] ^= 1;
  expect_error([&] { decode_serialized(damaged, "a.serialized", 0); }, "data are wrong");
  EXPECT_EQ(decode_serialized(damaged, "a.serialized", 1).positions.size(), 3u);
  for (const std::uint64_t huge : {std::uint64_t{4'000'000'000}, ~std::uint64_t{0}}) {
    expect_error([&] { decode_serialized(file_of({.vertices = huge}), "a.serialized", 0); }, "");
    expect_error([&] { decode_serialized(file_of({.triangles = huge}), "a.serialized", 0); }, "");
  }
}

TEST(Serialized, MitsubasShapeIsTheFirstUnlessItSays) {
  const TempFolder folder;
  write_text(folder.file("a.serialized"), file_of({}));
  const auto height = [&](const std::string& inside) {
    write_text(folder.file("scene.xml"),
               "<scene version='3.0.0'><shape type='serialized'><string name='filename' "
               "value='a.serialized'/>" +
                   inside + "</shape></scene>");
    return load_with_warnings(folder.file("scene.xml")).scene.meshes.at(0).positions.at(0).z;
  };
  EXPECT_EQ(height(""), 0.0f);
  EXPECT_EQ(height("<integer name='shape_index' value='1'/>"), 1.0f);
  EXPECT_EQ(height("<integer name='shape_index' value='2'/>"), 2.0f);
}

}  // namespace
}  // namespace pt
