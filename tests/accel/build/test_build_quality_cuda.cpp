// How good the trees built on the device are, and how long they take.
#include <cstdlib>

#include "accel/device_tree.h"
#include "accel/serial_reinsertion.h"
#include "common/accel/build/binary/build_binary.h"
#include "common/accel/build/build_triangle_tree.h"
#include "common/accel/build/morton_order.h"

namespace pt {
namespace {

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
    const double reinserted = relative(DeviceBuilder::hploc_reinsert);
    std::printf("%s: H-PLOC %.3f, reinserted %.3f, LBVH %.3f of the CPU's SAH cost\n", scene.name,
                hploc, reinserted, lbvh);
    EXPECT_LT(reinserted, 1.04) << scene.name;
    EXPECT_LT(reinserted, 0.96 * hploc) << scene.name;
    EXPECT_LT(hploc, 1.15) << scene.name;
    EXPECT_LT(hploc, lbvh) << scene.name;
    EXPECT_LT(lbvh, 2.0) << scene.name;
  }
}

// Other roundings of areas make other trees, which cost the same.
TEST_F(CudaBuild, ReinsertionGainsAsMuchAsOnTheCpu) {
  for (const BuildCase& scene : {build_cases[0], build_cases[1]}) {
    const std::vector<Triangle> triangles = scene.make(100'000);
    std::vector<Bounds> boxes;
    for (const Triangle& t : triangles) boxes.push_back(hit_bounds(t.v0, t.v1, t.v2));
    HostBuildTree expected = SerialHploc(boxes).tree;
    DeviceBuildOptions options = binary_options();
    options.costs.leaf_max = 1;
    const auto expect_equal_cost = [&](DeviceBuilder builder) {
      double cost = 0;
      for (std::uint32_t i = 0; i < expected.count(); ++i) {
        cost += expected.primitives[i].bounds().half_area();
        if (expected.nodes[i].left != device_build::no_node) {
          cost += expected.nodes[i].bounds().half_area();
        }
      }
      cost /= expected[expected.root].bounds().half_area();
      options.builder = builder;
      const TreeQuality quality = builder_->measure(build(triangles, options));
      EXPECT_NEAR(quality.sah_cost(1.0) / cost, 1, 0.01) << scene.name << name_of(builder);
    };
    expect_equal_cost(DeviceBuilder::hploc);
    SerialReinsertion(expected, run_forward).run();
    expect_equal_cost(DeviceBuilder::hploc_reinsert);
  }
}

void print_cpu_trees(const Mesh& mesh) {
  for (const AccelKind accel : {AccelKind::bvh2, AccelKind::cwbvh}) {
    TreeOptions options;
    options.accel = accel, options.builder = TreeBuilder::sah;
    const TriangleTreeData tree = build_triangle_tree(std::span(&mesh, 1), {}, options);
    const bool is_wide = accel == AccelKind::cwbvh;
    const TreeQuality quality =
        is_wide ? measure_tree(std::span(tree.cwbvh), 0) : measure_tree(std::span(tree.bvh2), 0);
    std::printf("%-88s %7.0f | %9llu %9.3f %5d\n", is_wide ? "cpu sah cwbvh" : "cpu sah bvh2",
                tree.build_ms, static_cast<unsigned long long>(quality.nodes),
                quality.sah_cost(is_wide ? cwbvh_triangle_cost : 1.0), quality.depth);
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
      "%u triangles, ms: median of %d\n%-32s %7s %7s %7s %7s %7s %7s %7s %7s | %9s %9s %5s %s\n",
      count, repeats, "", "bounds", "morton", "sort", "tree", "reins.", "nodes", "records", "total",
      "nodes", "SAH cost", "depth", "scratch MB");
  if (std::getenv("PTEXP_LARGE_SAH") != nullptr) print_cpu_trees(hills);
  for (const DeviceBuildOptions& options : all_options()) {
    if (options.builder == DeviceBuilder::balanced) continue;
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
        "%-32s %7.3f %7.3f %7.3f %7.3f %7.3f %7.3f %7.3f %7.3f | %9llu %9.3f %5d %.0f\n",
        name_of(options).c_str(), median([](auto& t) { return t.bounds_ms; }),
        median([](auto& t) { return t.morton_ms; }), median([](auto& t) { return t.sort_ms; }),
        median([](auto& t) { return t.hierarchy_ms; }),
        median([](auto& t) { return t.reinsertion_ms; }),
        median([](auto& t) { return t.collapse_ms; }),
        median([](auto& t) { return t.triangles_ms; }),
        median([](auto& t) { return t.total_ms(); }),
        static_cast<unsigned long long>(quality.nodes), quality.sah_cost(options.costs.triangle),
        tree.depth, static_cast<double>(tree.scratch_bytes) / 1e6);
  }
}

}  // namespace
}  // namespace pt
