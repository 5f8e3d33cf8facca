// Files of meshes, rays and hits: what is written is read back, what is wrong is refused by name.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "common/rays/ray_file.h"
#include "temp_folder.h"

namespace pt {
namespace {

template <class Read>
void expect_refused(const std::string& bytes, const std::string& problem, Read read) {
  const TempFolder folder;
  const std::string path = folder.file("bad");
  write_text(path, bytes);
  expect_error([&] { read(path); }, problem);
  expect_error([&] { read(path); }, path);
}

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

Mesh small_mesh() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  return mesh;
}

RaySet small_rays() {
  return {RayType::any, {{{1, 2, 3}, 0.5f, {0, 0, -2}, 7}, {{0, 0, 1}, 0, {1, 0, 0}, 1e30f}}};
}

template <class Write>
std::string written(Write write) {
  const TempFolder folder;
  const std::string path = folder.file("file");
  write(path);
  return read_text(path);
}
std::string mesh_bytes() {
  return written([](const std::string& path) { write_trace_mesh(path, small_mesh()); });
}
std::string ray_bytes() {
  return written([](const std::string& path) { write_rays(path, small_rays()); });
}

TEST(RayFile, MeshesAreReadBack) {
  const TempFolder folder;
  const std::string path = folder.file("a.mesh");
  const Mesh mesh = small_mesh();
  write_trace_mesh(path, mesh);
  EXPECT_EQ(read_text(path).size(), 16u + 4 * 12 + 2 * 12);
  const Mesh copy = read_trace_mesh(path);
  EXPECT_EQ(copy.positions, mesh.positions);
  ASSERT_EQ(copy.triangles.size(), 2u);
  EXPECT_EQ(copy.triangles[1].v[2], 3u);
}

TEST(RayFile, RaysAndHitsAreReadBack) {
  const TempFolder folder;
  const std::string rays_path = folder.file("a.rays");
  const std::string hits_path = folder.file("a.hits");
  write_rays(rays_path, small_rays());
  EXPECT_EQ(read_text(rays_path).size(), 32u + 2 * 32);
  const RaySet rays = read_rays(rays_path);
  EXPECT_EQ(rays.type, RayType::any);
  ASSERT_EQ(rays.rays.size(), 2u);
  EXPECT_EQ(rays.rays[0].origin, Vec3(1, 2, 3));
  EXPECT_EQ(rays.rays[0].t_min, 0.5f);
  EXPECT_EQ(rays.rays[0].direction, Vec3(0, 0, -2));
  EXPECT_EQ(rays.rays[0].t_max, 7.0f);
  write_hits(hits_path, {RayType::closest, {{1.5f, 3}, {-1, no_primitive}}});
  const HitSet hits = read_hits(hits_path);
  EXPECT_EQ(hits.type, RayType::closest);
  ASSERT_EQ(hits.hits.size(), 2u);
  EXPECT_EQ(hits.hits[0].primitive, 3u);
  EXPECT_EQ(hits.hits[1].t, -1.0f);
}

TEST(RayFile, BrokenMeshesAreRefused) {
  const auto read = [](const std::string& path) { read_trace_mesh(path); };
  const std::string good = mesh_bytes();
  expect_refused("", "too short", read);
  expect_refused(good.substr(0, 15), "too short", read);
  expect_refused("X" + good.substr(1), "TRBMESH1", read);
  expect_refused(good.substr(0, good.size() - 1), "header says", read);
  expect_refused(good + 'x', "header says", read);
  std::string bad = good;
  put(bad, 8, 0xffffffffu);
  expect_refused(bad, "header says", read);
  bad = good;
  put(bad, 16, std::numeric_limits<float>::quiet_NaN());
  expect_refused(bad, "vertex 0", read);
  bad = good;
  put(bad, good.size() - 4, 4u);
  expect_refused(bad, "triangle 1 has vertex 4", read);
  EXPECT_THROW(read_trace_mesh("/no/such/file"), Error);
}

TEST(RayFile, BrokenRaysAreRefused) {
  const auto read = [](const std::string& path) { read_rays(path); };
  const std::string good = ray_bytes();
  expect_refused(mesh_bytes(), "TRBRAYS1", read);
  expect_refused(good.substr(0, good.size() - 4), "header says", read);
  std::string bad = good;
  put(bad, 8, std::uint64_t{1} << 60);
  expect_refused(bad, "entries", read);
  bad = good;
  put(bad, 16, 2u);
  expect_refused(bad, "type 2", read);
  bad = good;
  put(bad, 32 + 32, std::numeric_limits<float>::infinity());
  expect_refused(bad, "ray 1 is not finite", read);
  bad = good;
  put(bad, 32 + 24, 0.0f);
  expect_refused(bad, "ray 0 has no direction", read);
  bad = good;
  put(bad, 32 + 12, -1.0f);
  expect_refused(bad, "ray 0", read);
  bad = good;
  put(bad, 32 + 28, std::numeric_limits<float>::quiet_NaN());
  expect_refused(bad, "ray 0", read);
}

}  // namespace
}  // namespace pt
