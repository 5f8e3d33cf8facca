// Trees built on the device: they hold everything, are as good as they should be, and find what
// testing every triangle finds.
#include <gtest/gtest.h>

#include <cstring>

#include "build_cases.h"
#include "common/accel/build_device.h"
#include "common/accel/build_sah.h"
#include "common/accel/build_triangle_tree.h"
#include "common/accel/morton.h"
#include "common/accel/traverse_cwbvh.h"
#include "common/accel/traverse_triangles_brute.h"
#include "common/accel/traverse_triangles_bvh2.h"
#include "common/device/cuda_memory.cuh"
#include "common/error.h"
#include "cuda_test.h"

namespace pt {
namespace {

const char* name_of(DeviceBuilder builder) {
  return builder == DeviceBuilder::lbvh    ? "lbvh"
         : builder == DeviceBuilder::hploc ? "hploc"
                                           : "balanced";
}

std::string name_of(const DeviceBuildOptions& options) {
  const bool is_wide = options.format == TreeFormat::cwbvh;
  const bool is_optimal = is_wide && options.collapse == Collapse::optimal;
  return std::string(name_of(options.builder)) +
         (is_optimal ? " optimal cwbvh"
          : is_wide  ? " greedy cwbvh"
                     : " bvh2") +
         ", " + std::to_string(3 * options.morton_bits) + " bits";
}

DeviceBuildOptions binary_options() {
  DeviceBuildOptions options;
  options.format = TreeFormat::bvh2;
  options.costs = {1.0f, 1.0f, 4};
  return options;
}

std::vector<DeviceBuildOptions> all_options() {
  std::vector<DeviceBuildOptions> all;
  for (const DeviceBuilder builder :
       {DeviceBuilder::lbvh, DeviceBuilder::hploc, DeviceBuilder::balanced}) {
    for (const int format : {0, 1, 2}) {
      DeviceBuildOptions options = format == 0 ? binary_options() : DeviceBuildOptions{};
      if (format == 1) options.collapse = Collapse::greedy;
      options.builder = builder;
      options.depth_max = 1000;  // some cases are deep; nothing is to be replaced here
      all.push_back(options);
    }
  }
  all.push_back(all.back());
  all.back().morton_bits = 10;
  all.push_back(all[3]);
  all.back().morton_bits = 7;
  return all;
}

/// A tree in host memory.
struct HostTree {
  std::vector<Bvh2Node> bvh2;
  std::vector<CwbvhNode> cwbvh;
  std::vector<std::uint32_t> order;
  std::vector<Triangle> triangles;

  TriangleTree view() const {
    TriangleTree tree;
    tree.bvh2 = bvh2.data(), tree.cwbvh = cwbvh.data();
    tree.triangles = triangles.data();
    tree.triangle_count = static_cast<std::uint32_t>(triangles.size());
    return tree;
  }
  TreeQuality quality() const {
    return bvh2.empty() ? measure_tree(std::span<const CwbvhNode>(cwbvh), 0)
                        : measure_tree(std::span<const Bvh2Node>(bvh2), 0);
  }
};

template <class T>
std::vector<T> download(const T* from, std::size_t count) {
  std::vector<T> values(from == nullptr ? 0 : count);
  check_cuda(cudaMemcpy(values.data(), from, values.size() * sizeof(T), cudaMemcpyDeviceToHost),
             "download");
  return values;
}

HostTree download(const DeviceTree& tree) {
  return {download(tree.bvh2, tree.node_count), download(tree.cwbvh, tree.node_count),
          download(tree.order, tree.slot_count), download(tree.triangles, tree.slot_count)};
}

class CudaBuild : public CudaTest {
 protected:
  void SetUp() override {
    CudaTest::SetUp();
    if (IsSkipped()) return;
    builder_ = std::make_unique<DeviceTreeBuilder>(
        [this](const std::string& name, std::uint64_t size_bytes) {
          return memory_->allocate<char>(name, size_bytes);
        });
  }

  DeviceTree build(const std::vector<Triangle>& triangles, const DeviceBuildOptions& options) {
    source_ = std::make_unique<DeviceArray<Triangle>>(triangles);
    return builder_->build(source(), static_cast<std::uint32_t>(triangles.size()), options);
  }
  TriangleSource source() const {
    TriangleSource source;
    source.records = source_->data();
    return source;
  }
  void forget_outputs() { memory_ = std::make_unique<CudaMemory>(); }

  std::unique_ptr<CudaMemory> memory_ = std::make_unique<CudaMemory>();
  std::unique_ptr<DeviceTreeBuilder> builder_;
  std::unique_ptr<DeviceArray<Triangle>> source_;
};

/// Every triangle in one slot, its record unchanged; nodes and boxes as check_tree wants them.
void check_triangles(const HostTree& tree, const std::vector<Triangle>& triangles) {
  ASSERT_EQ(tree.order.size(), triangles.size());
  std::vector<int> seen(triangles.size());
  std::vector<Bounds> bounds;
  for (std::size_t slot = 0; slot < tree.order.size(); ++slot) {
    const std::uint32_t i = tree.order[slot];
    ASSERT_LT(i, triangles.size());
    ++seen[i];
    ASSERT_EQ(std::memcmp(&tree.triangles[slot], &triangles[i], sizeof(Triangle)), 0);
    bounds.push_back(triangle_bounds(triangles[i].v0, triangles[i].v1, triangles[i].v2));
  }
  ASSERT_EQ(seen, std::vector<int>(triangles.size(), 1));
  tree.bvh2.empty() ? check_tree(tree.cwbvh, bounds) : check_tree(tree.bvh2, bounds);
}

TEST_F(CudaBuild, TreesHoldEveryTriangleOnce) {
  for (const BuildCase& scene : build_cases) {
    for (const std::uint32_t count :
         {1u, 2u, 3u, 4u, 5u, 8u, 15u, 16u, 17u, 31u, 32u, 33u, 100u, 1000u, 20'000u}) {
      const std::vector<Triangle> triangles = scene.make(count);
      for (const DeviceBuildOptions& options : all_options()) {
        SCOPED_TRACE(testing::Message()
                     << scene.name << ", " << count << " triangles, " << name_of(options));
        const DeviceTree tree = build(triangles, options);
        const HostTree host = download(tree);
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
    const Hit expected = closest_triangle_brute<false>(plain, ray, 0.0f, infinite_distance);
    const Hit hit = tree.bvh2.empty()
                        ? closest_triangle_cwbvh<false>(tree.view(), ray, 0.0f, infinite_distance)
                        : closest_triangle_bvh2<false>(tree.view(), ray, 0.0f, infinite_distance);
    ASSERT_EQ(hit.is_miss(), expected.is_miss()) << "ray " << i;
    if (hit.is_miss()) continue;
    ++hits;
    ASSERT_EQ(hit.t, expected.t) << "ray " << i;
    ASSERT_EQ(tree.triangles[hit.primitive].id, triangles[expected.primitive].id) << "ray " << i;
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
        expect_brute_force_hits(download(build(triangles, options)), triangles, 200);
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
    const TreeQuality first = download(build(triangles, options)).quality();
    for (int repeat = 0; repeat < 3; ++repeat) {
      const TreeQuality next = download(build(triangles, options)).quality();
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
  std::vector<MeshRange> ranges{{0, 0, 7, 1}};
  for (std::uint32_t copy = 1; copy < 4; ++copy) {
    ranges.push_back({static_cast<std::uint32_t>(indices.size()),
                      static_cast<std::uint32_t>(positions.size()), 10 + copy, copy % 3});
    for (const Vec3& p : hills.positions) positions.push_back(p + static_cast<float>(copy));
    indices.insert(indices.end(), hills.triangles.begin(), hills.triangles.end());
  }
  const DeviceArray<Vec3> device_positions(positions);
  const DeviceArray<TriangleIndices> device_indices(indices);
  const DeviceArray<MeshRange> device_ranges(ranges);
  TriangleSource source;
  source.positions = device_positions.data(), source.indices = device_indices.data();
  source.ranges = device_ranges.data(), source.range_count = 4;
  source.first_id = 100;
  const auto count = static_cast<std::uint32_t>(indices.size());
  const HostTree tree = download(builder_->build(source, count, {}));
  std::vector<Triangle> expected(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const MeshRange& range = ranges[i / hills.triangles.size()];
    const Vec3* p = positions.data() + range.first_vertex;
    const TriangleIndices& v = indices[i];
    expected[i] = {p[v.v[0]], 100 + i, p[v.v[1]], range.material, p[v.v[2]], range.attributes};
  }
  check_triangles(tree, expected);
}

TEST_F(CudaBuild, TreesOverBoxesAndWithOffsets) {
  std::vector<Bounds> boxes;
  for (const Triangle& t : make_soup(700, 10, 3))
    boxes.push_back(triangle_bounds(t.v0, t.v1, t.v2));
  const DeviceArray<Bounds> device(boxes);
  for (DeviceBuildOptions options : {binary_options(), DeviceBuildOptions{}}) {
    options.costs.leaf_max = 1;
    options.first_node = 1000, options.first_slot = 5000;
    const DeviceTree tree = builder_->build(device.data(), 700, options);
    EXPECT_EQ(tree.triangles, nullptr);
    const HostTree host = download(tree);
    std::vector<Bounds> by_slot;
    for (const std::uint32_t i : host.order) by_slot.push_back(boxes.at(i));
    host.bvh2.empty() ? check_tree(host.cwbvh, by_slot, 1000, 5000)
                      : check_tree(host.bvh2, by_slot, 1000, 5000);
    EXPECT_EQ(builder_->measure(tree).leaves, 700u) << "one box per leaf";
  }
}

TEST_F(CudaBuild, RefittedTreesHoldTheMovedTriangles) {
  for (const std::uint32_t count : {1u, 2u, 40u, 30'000u}) {
    const std::vector<Triangle> triangles = make_soup(count, 10, 1);
    std::vector<Triangle> moved = triangles;
    for (Triangle& t : moved)
      for (Vec3* v : {&t.v0, &t.v1, &t.v2}) *v = Vec3(v->y, 2 * v->x, v->z + 0.1f * v->x * v->y);
    for (const DeviceBuildOptions& options : all_options()) {
      SCOPED_TRACE(testing::Message() << count << " triangles, " << name_of(options));
      DeviceTree tree = build(triangles, options);
      const TreeQuality before = builder_->measure(tree);
      source_ = std::make_unique<DeviceArray<Triangle>>(moved);
      builder_->refit(tree, source(), options);
      const HostTree host = download(tree);
      check_triangles(host, moved);
      if (count > 30 && count < 1000) expect_brute_force_hits(host, moved, 200);
      source_ = std::make_unique<DeviceArray<Triangle>>(triangles);
      builder_->refit(tree, source(), options);
      EXPECT_NEAR(builder_->measure(tree).nodes_per_ray, before.nodes_per_ray,
                  1e-5 * before.nodes_per_ray)
          << "there and back again";
      if (HasFailure()) return;
      forget_outputs();
    }
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
  check_triangles(download(tree), triangles);
  options.depth_max = 12;
  try {
    build(triangles, options);
    FAIL() << "a tree that is too deep";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "the tree is 13 nodes deep; expected at most 12");
  }
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
  options.morton_bits = 22;
  EXPECT_EQ(message(triangles, options), "building a tree: morton_bits is 22; expected 1 to 21");
  for (const float bad : {NAN, HUGE_VALF, -2e15f}) {
    triangles[42].v1.y = bad;
    EXPECT_EQ(message(triangles, {}),
              "building a tree: coordinates must be finite and within 1e15");
  }
}

/// Expected steps of a ray in the CPU builder's binary tree of single triangles.
double sah_cost_of_cpu(const std::vector<Triangle>& triangles) {
  const BinaryTree tree =
      build_sah(static_cast<std::uint32_t>(triangles.size()), [&](std::uint32_t i) {
        return triangle_bounds(triangles[i].v0, triangles[i].v1, triangles[i].v2);
      });
  return measure_tree(std::span(tree.nodes.get(), tree.node_capacity), tree.root).sah_cost(1.0);
}

TEST_F(CudaBuild, TreesAreNearlyAsGoodAsTheCpuBuilders) {
  for (const BuildCase& scene : {build_cases[0], build_cases[1]}) {
    const std::vector<Triangle> triangles = scene.make(100'000);
    const double reference = sah_cost_of_cpu(triangles);
    DeviceBuildOptions options = binary_options();
    options.costs.leaf_max = 1;
    const auto relative = [&](DeviceBuilder builder) {
      options.builder = builder;
      return builder_->measure(build(triangles, options)).sah_cost(1.0) / reference;
    };
    const double hploc = relative(DeviceBuilder::hploc), lbvh = relative(DeviceBuilder::lbvh);
    std::printf("%s: H-PLOC %.3f, LBVH %.3f of the CPU's SAH cost\n", scene.name, hploc, lbvh);
    EXPECT_LT(hploc, 1.15) << scene.name;
    EXPECT_LT(hploc, lbvh) << scene.name;
    EXPECT_LT(lbvh, 2.0) << scene.name;
  }
}

void print_cpu_trees(const Mesh& mesh) {
  for (const AccelKind accel : {AccelKind::bvh2, AccelKind::cwbvh}) {
    TreeOptions options;
    options.accel = accel;
    const TriangleTreeData tree = build_triangle_tree(std::span(&mesh, 1), {}, options);
    const bool is_wide = accel == AccelKind::cwbvh;
    const TreeQuality quality =
        is_wide ? measure_tree(std::span(tree.cwbvh), 0) : measure_tree(std::span(tree.bvh2), 0);
    std::printf("%-88s %7.0f | %9llu %9.3f %5d\n", is_wide ? "cpu sah cwbvh" : "cpu sah bvh2",
                tree.build_ms, static_cast<unsigned long long>(quality.nodes),
                quality.sah_cost(is_wide ? 0.3 : 1.0), quality.depth);
  }
}

// What a build costs: PTEXP_LARGE_TESTS=<triangles>[:part of a name] prints times of several
// builds.
TEST_F(CudaBuild, TimesOfALargeBuild) {
  const char* text = std::getenv("PTEXP_LARGE_TESTS");
  if (text == nullptr) GTEST_SKIP() << "PTEXP_LARGE_TESTS=<triangles> is not set";
  const char* colon = std::strchr(text, ':');
  const std::string wanted = colon == nullptr ? "" : colon + 1;
  const Mesh hills = make_hills(static_cast<std::uint32_t>(std::atoll(text)));
  const auto count = static_cast<std::uint32_t>(hills.triangles.size());
  const DeviceArray<Vec3> positions(hills.positions);
  const DeviceArray<TriangleIndices> indices(hills.triangles);
  TriangleSource triangles;
  triangles.positions = positions.data(), triangles.indices = indices.data();
  const int repeats = count > 50'000'000 ? 3 : 11;
  std::printf(
      "%u triangles, ms: median of %d\n%-32s %7s %7s %7s %7s %7s %7s %7s | %9s %9s %5s %s\n", count,
      repeats, "", "bounds", "morton", "sort", "tree", "nodes", "records", "total", "nodes",
      "SAH cost", "depth", "scratch MB");
  if (std::getenv("PTEXP_LARGE_SAH") != nullptr) print_cpu_trees(hills);
  for (const DeviceBuildOptions& base : all_options()) {
    for (const int bits : {10, 16, 21}) {
      DeviceBuildOptions options = base;
      if (options.morton_bits != morton_bits_max || options.builder == DeviceBuilder::balanced ||
          (bits != 21 && options.format == TreeFormat::bvh2)) {
        continue;
      }
      options.morton_bits = bits;
      if (name_of(options).find(wanted) == std::string::npos) continue;
      DeviceTree tree;
      std::vector<DeviceBuildTimes> times;
      for (int i = 0; i < repeats + 2; ++i) {  // the first two warm up
        forget_outputs();
        tree = builder_->build(triangles, count, options);
        if (i >= 2) times.push_back(tree.times);
      }
      const auto median = [&](auto&& value) {
        std::vector<float> values;
        for (const DeviceBuildTimes& t : times) values.push_back(value(t));
        std::sort(values.begin(), values.end());
        return values[values.size() / 2];
      };
      const TreeQuality quality = builder_->measure(tree);
      EXPECT_EQ(quality.slots, count);
      std::printf(
          "%-32s %7.3f %7.3f %7.3f %7.3f %7.3f %7.3f %7.3f | %9llu %9.3f %5d %.0f\n",
          name_of(options).c_str(), median([](auto& t) { return t.bounds_ms; }),
          median([](auto& t) { return t.morton_ms; }), median([](auto& t) { return t.sort_ms; }),
          median([](auto& t) { return t.hierarchy_ms; }),
          median([](auto& t) { return t.collapse_ms; }),
          median([](auto& t) { return t.triangles_ms; }),
          median([](auto& t) { return t.total_ms(); }),
          static_cast<unsigned long long>(quality.nodes), quality.sah_cost(options.costs.triangle),
          tree.depth, static_cast<double>(tree.scratch_bytes) / 1e6);
    }
  }
}

}  // namespace
}  // namespace pt
