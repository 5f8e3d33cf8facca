// Trees built on the device hold everything and find what testing every triangle finds.
#include "accel/device_tree.h"
#include "common/accel/traverse_triangles.h"
#include "common/error/error.h"

namespace pt {
namespace {

TEST_F(CudaBuild, TreesHoldEveryTriangleOnce) {
  for (const BuildCase& scene : build_cases) {
    for (const std::uint32_t count :
         {1u, 2u, 3u, 4u, 5u, 8u, 15u, 16u, 17u, 31u, 32u, 33u, 100u, 1000u, 20'000u}) {
      const std::vector<Triangle> triangles = scene.make(count);
      for (const DeviceBuildOptions& options : all_options()) {
        SCOPED_TRACE(testing::Message()
                     << scene.name << ", " << count << " triangles, " << name_of(options));
        const DeviceTree tree = build(triangles, options);
        const HostTree host = download(tree, options);
        check_triangles(host, triangles);
        const TreeQuality expected = host.quality(), measured = builder_->measure(tree);
        EXPECT_EQ(tree.depth, expected.depth);
        EXPECT_EQ(measured.nodes, expected.nodes);
        EXPECT_EQ(measured.leaves, expected.leaves);
        EXPECT_EQ(measured.slots, expected.slots);
        if (HasFailure()) return;
        forget_outputs();
      }
    }
  }
}

/// From near the scene to a triangle, some along a plane of two axes.
Ray random_ray(TestRandom& random, const std::vector<Triangle>& triangles, const Bounds& scene) {
  const Vec3 size = scene.max - scene.min;
  const Triangle to = triangles[random.below(static_cast<std::uint32_t>(triangles.size()))];
  Ray ray{scene.center() + point_in_cube(random, std::max(max_abs(size), 1e-6f)), {}};
  ray.direction = (to.v0 + to.v1 + to.v2) / 3.0f - ray.origin;
  if (random.bits() % 4 == 0) ray.direction[random.below(3)] = 0;
  if (!(max_abs(ray.direction) > 0)) ray.direction = {0, 0, 1};
  return ray;
}

void expect_brute_force_hits(const HostTree& tree, const std::vector<Triangle>& triangles,
                             int rays) {
  TriangleTree plain;
  plain.triangles = triangles.data();
  plain.triangle_count = static_cast<std::uint32_t>(triangles.size());
  Bounds scene;
  for (const Triangle& t : triangles) scene.grow(triangle_bounds(t.v0, t.v1, t.v2));
  TestRandom random(11);
  int hits = 0;
  for (int i = 0; i < rays; ++i) {
    const Ray ray = random_ray(random, triangles, scene);
    const Hit expected = closest_triangle<Accel::brute, false>(plain, ray, 0.0f, infinite_distance);
    const Hit hit =
        tree.data.bvh2.empty()
            ? closest_triangle<Accel::cwbvh, false>(tree.data.view(), ray, 0.0f, infinite_distance)
            : closest_triangle<Accel::bvh2, false>(tree.data.view(), ray, 0.0f, infinite_distance);
    ASSERT_EQ(hit.is_miss(), expected.is_miss()) << "ray " << i;
    if (hit.is_miss()) continue;
    ++hits;
    ASSERT_EQ(hit.t, expected.t) << "ray " << i;
    ASSERT_EQ(tree.data.triangles[hit.primitive].id, triangles[expected.primitive].id)
        << "ray " << i;
  }
  EXPECT_GT(hits, rays / 20);
}

TEST_F(CudaBuild, RaysFindWhatTestingEveryTriangleFinds) {
  for (const BuildCase& scene : {build_cases[0], build_cases[1], build_cases[2], build_cases[8]}) {
    for (const std::uint32_t count : {1u, 2u, 3u, 50u, 3000u}) {
      const std::vector<Triangle> triangles = scene.make(count);
      for (DeviceBuildOptions options : all_options()) {
        SCOPED_TRACE(testing::Message()
                     << scene.name << ", " << count << " triangles, " << name_of(options));
        options.depth_max = bvh_depth_max;
        expect_brute_force_hits(download(build(triangles, options), options), triangles, 200);
        if (HasFailure()) return;
        forget_outputs();
      }
    }
  }
}

// Built twice, nodes may lie elsewhere, but the tree is the same.
TEST_F(CudaBuild, TreesDoNotDependOnTheOrderOfThreads) {
  const std::vector<Triangle> triangles = make_soup(50'000, 10, 0.2);
  for (const DeviceBuildOptions& options : all_options()) {
    const TreeQuality first = download(build(triangles, options), options).quality();
    for (int repeat = 0; repeat < 3; ++repeat) {
      const TreeQuality next = download(build(triangles, options), options).quality();
      EXPECT_EQ(next.nodes, first.nodes) << name_of(options);
      EXPECT_EQ(next.depth, first.depth) << name_of(options);
      EXPECT_EQ(next.nodes_per_ray, first.nodes_per_ray) << name_of(options);
      EXPECT_EQ(next.triangles_per_ray, first.triangles_per_ray) << name_of(options);
    }
    forget_outputs();
  }
}

TEST_F(CudaBuild, MeshesGiveTheRecordsOfTheirTriangles) {
  const Mesh hills = make_hills(500);
  std::vector<Vec3> positions = hills.positions;
  std::vector<TriangleIndices> indices = hills.triangles;
  std::vector<MeshRange> ranges{{0, 0, 7, 1, 100}};
  for (std::uint32_t copy = 1; copy < 4; ++copy) {
    ranges.push_back({static_cast<std::uint32_t>(indices.size()),
                      static_cast<std::uint32_t>(positions.size()), 10 + copy, copy % 3,
                      100 * copy * copy});
    for (const Vec3& p : hills.positions) positions.push_back(p + static_cast<float>(copy));
    indices.insert(indices.end(), hills.triangles.begin(), hills.triangles.end());
  }
  const DeviceArray<Vec3> device_positions(positions);
  const DeviceArray<TriangleIndices> device_indices(indices);
  const DeviceArray<MeshRange> device_ranges(ranges);
  TriangleSource source;
  source.positions = device_positions.data(), source.indices = device_indices.data();
  source.ranges = device_ranges.data(), source.range_count = 4;
  const auto count = static_cast<std::uint32_t>(indices.size());
  const HostTree tree = download(builder_->build(source, count, {}), {});
  std::vector<Triangle> expected(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const MeshRange& range = ranges[i / hills.triangles.size()];
    const Vec3* p = positions.data() + range.first_vertex;
    const TriangleIndices& v = indices[i];
    const std::uint32_t id = range.first_id + i - range.first_triangle;
    expected[i] = {p[v.v[0]], id, p[v.v[1]], range.material, p[v.v[2]], range.attributes};
  }
  check_triangles(tree, expected);
}

TEST_F(CudaBuild, TreesWithOffsets) {
  const std::vector<Triangle> triangles = make_soup(700, 10, 3);
  for (DeviceBuildOptions options : {binary_options(), DeviceBuildOptions{}}) {
    options.costs.leaf_max = 1;
    options.first_node = 1000, options.first_slot = 5000;
    const DeviceTree tree = build(triangles, options);
    EXPECT_EQ(builder_->measure(tree).leaves, 700u) << "one triangle per leaf";
    check_triangles(download(tree, options), triangles);
  }
}

TEST_F(CudaBuild, TooDeepTreesAreReplaced) {
  const std::vector<Triangle> triangles = make_soup(5000, 10, 1);
  DeviceBuildOptions options = binary_options();
  options.costs.leaf_max = 1;
  options.depth_max = 13;  // what halving 5,000 needs
  const DeviceTree tree = build(triangles, options);
  EXPECT_EQ(tree.builder, DeviceBuilder::balanced);
  EXPECT_EQ(tree.depth, 13);
  check_triangles(download(tree, options), triangles);
  options.depth_max = 12;
  try {
    build(triangles, options);
    FAIL() << "a tree that is too deep";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "the tree is 13 nodes deep; expected at most 12");
  }
}

// Boxes around one another are cheapest as a list, which is deep.
TEST_F(CudaBuild, WhatReinsertionMakesTooDeepIsBuiltWithout) {
  const std::vector<Triangle> triangles = build_cases[3].make(3000);
  DeviceBuildOptions options = binary_options();
  options.costs.leaf_max = 1;
  options.depth_max = 100'000;
  options.builder = DeviceBuilder::hploc_reinsert;
  const DeviceTree deep = build(triangles, options);
  EXPECT_EQ(deep.builder, DeviceBuilder::hploc_reinsert);
  options.builder = DeviceBuilder::hploc;
  const DeviceTree plain = build(triangles, options);
  ASSERT_GT(deep.depth, plain.depth);
  options.builder = DeviceBuilder::hploc_reinsert;
  options.depth_max = plain.depth;
  const DeviceTree tree = build(triangles, options);
  EXPECT_EQ(tree.builder, DeviceBuilder::hploc);
  EXPECT_EQ(tree.depth, plain.depth);
  check_triangles(download(tree, options), triangles);
}

TEST_F(CudaBuild, RefusesWhatItCannotBuild) {
  const auto message = [&](const std::vector<Triangle>& triangles, DeviceBuildOptions options) {
    try {
      build(triangles, options);
      return std::string("no error");
    } catch (const Error& error) {
      return std::string(error.what());
    }
  };
  std::vector<Triangle> triangles = make_soup(100, 1, 1);
  DeviceBuildOptions options;
  EXPECT_EQ(builder_->build(source_ ? source() : TriangleSource{}, 0, options).node_count, 0u);
  options.costs.leaf_max = 9;
  EXPECT_EQ(message(triangles, options), "building a tree: leaf_max is 9; expected 1 to 8");
  for (const float bad : {NAN, HUGE_VALF, -2e15f}) {
    triangles[42].v1.y = bad;
    EXPECT_EQ(message(triangles, {}),
              "building a tree: coordinates must be finite and within 1e12");
  }
}

}  // namespace
}  // namespace pt
