// Lanes as kernels count them, against what the statistics and the queues say. Only in a build that
// counts them (PTEXP_DIVERGENCE).
#include <algorithm>
#include <map>

#include "common/render/lane_histograms.h"
#include "cuda_test.h"
#include "mode_cases.h"

namespace pt {
namespace {

constexpr int lanes_width = 64, lanes_height = 32, lanes_spp = 3;  // whole warps of camera rays

struct Counted {
  RenderReport report;

  const PathCounts& counts() const { return report.counts; }

  LaneUse at(const std::string& point) const {
    const std::vector<LaneUse> uses = lane_use(report.divergence);
    const auto use = std::ranges::find(uses, point, &LaneUse::point);
    return use != uses.end() ? *use : LaneUse{point};
  }

  /// [bounce], those that have counted anything.
  std::map<int, LaneUse> bounces_at(const std::string& point) const {
    std::map<int, LaneUse> result;
    for (const LaneHistogram& one : report.divergence)
      if (one.point == point) result[one.bounce] = lane_use({one})[0];
    return result;
  }
};

class CudaDivergence : public CudaTest {
 protected:
  void SetUp() override {
    CudaTest::SetUp();
    if (!IsSkipped() && !counts_lanes) GTEST_SKIP() << "a build without PTEXP_DIVERGENCE";
  }

  static Counted render(const std::string& scene, const std::string& mode, Settings more = {}) {
    Settings settings{{"scene", scene},
                      {"width", std::to_string(lanes_width)},
                      {"height", std::to_string(lanes_height)},
                      {"spp", std::to_string(lanes_spp)},
                      {"max-depth", "6"}};
    settings.insert(settings.end(), more.begin(), more.end());
    const Options options = cuda_options(mode, settings);
    SCOPED_TRACE(command_of(options));
    const DeviceInfo device = choose_device(options.device);
    const SceneData scene_data = make_scene_for(options, device);
    const auto renderer = make_renderer(options, scene_data, device);
    renderer->render({});
    renderer->render({});  // counts are the last render's alone
    Counted result;
    renderer->describe(result.report);
    return result;
  }
};

constexpr std::uint64_t camera_rays = std::uint64_t{lanes_width} * lanes_height * lanes_spp;

/// Lanes in as few groups as there can be.
std::uint64_t warps_of(std::uint64_t lanes) { return (lanes + 31) / 32; }

void expect_every_ray_once(const Counted& found) {
  const PathCounts& counts = found.counts();
  EXPECT_EQ(found.at("generate").lanes, counts.paths);
  EXPECT_EQ(found.at("intersect").lanes, counts.rays);
  EXPECT_EQ(found.at("shadow").lanes, counts.shadow_rays);
  EXPECT_EQ(found.at("shade_surface").lanes + found.at("shade_miss").lanes, counts.rays);
}

TEST_F(CudaDivergence, EveryRayCountsOnce) {
  const std::vector<std::pair<std::string, std::string>> scenes{
      {"spheres", "brute"},  {"spheres", "bvh2"},         {"cornell", "bvh2"},
      {"boxes", "cwbvh"},    {"boxes", "bvh2"},           {"instances:20", "cwbvh"},
      {"statue:1K", "bvh2"}, {"dial:5:0:closed", "cwbvh"}};
  const std::vector<std::pair<std::string, Settings>> ways{
      {"megakernel", {{"work", "persistent"}}},
      {"megakernel", {{"work", "pixel"}}},
      {"megakernel", {{"work", "sample"}}},
      {"wavefront", {}},
      {"wavefront", {{"stages", "split"}}},
      {"wavefront", {{"stages", "fused"}, {"wave-rays", "2"}}},
      {"wavefront", {{"finish-paths", "0"}, {"schedule", "host"}}},
      {"wavefront", {{"finish-paths", "500"}, {"pool-size", "1000"}}},
      {"wavefront", {{"compaction", "none"}}},
      {"wavefront", {{"compaction", "cub"}, {"finish-paths", "0"}}}};
  for (const auto& [scene, accel] : scenes) {
    for (const auto& [mode, more] : ways) {
      Settings settings = more;
      settings.emplace_back("accel", accel);
      SCOPED_TRACE(scene + " " + accel + " " + mode + " " + (more.empty() ? "" : more[0].second));
      Settings all = settings;
      all.emplace_back("scene", scene);
      if (!has_plan(cuda_options(mode, all))) continue;
      const Counted found = render(scene, mode, settings);
      expect_every_ray_once(found);
      EXPECT_EQ(found.at("iteration").lanes > 0, mode == "megakernel");
      EXPECT_EQ(found.at("node").lanes > 0, accel != "brute");
      EXPECT_GT(found.at("primitive").lanes, 0u);
    }
  }
}

// In a pool that holds all paths a wave is a bounce.
TEST_F(CudaDivergence, BouncesAreThoseOfTheStatistics) {
  for (const std::string scene : {"spheres", "boxes"}) {
    const Counted found = render(scene, "wavefront", {{"finish-paths", "0"}});
    const auto intersect = found.bounces_at("intersect");
    const std::vector<std::uint64_t>& live = found.counts().live_paths;
    const auto alive = static_cast<std::size_t>(
        std::ranges::count_if(live, [](std::uint64_t paths) { return paths > 0; }));
    ASSERT_EQ(intersect.size(), alive);
    ASSERT_GT(alive, 2u);
    for (const auto& [bounce, use] : intersect) {
      EXPECT_EQ(use.lanes, live[static_cast<std::size_t>(bounce)]) << bounce;
      const auto shaded = found.bounces_at("shade_surface")[bounce].lanes;
      EXPECT_EQ(shaded + found.bounces_at("shade_miss")[bounce].lanes, use.lanes) << bounce;
    }
  }
}

// Queues are dense: all warps are full but the last one.
TEST_F(CudaDivergence, StagesOfQueuesHaveFullWarps) {
  const Counted found =
      render("spheres", "wavefront", {{"stages", "split"}, {"finish-paths", "0"}});
  const auto generate = found.bounces_at("generate");
  ASSERT_EQ(generate.size(), 1u);
  EXPECT_EQ(generate.at(0).groups, camera_rays / 32);
  for (const std::string point : {"intersect", "shade_surface", "shade_miss"}) {
    for (const auto& [bounce, use] : found.bounces_at(point)) {
      EXPECT_EQ(use.groups, warps_of(use.lanes)) << point << ", bounce " << bounce;
    }
  }
}

// Nothing parts the lanes of a warp where all surfaces are diffuse. The last bounce ends before its
// BSDF is asked.
TEST_F(CudaDivergence, OneKindOfBsdfHasFullWarps) {
  const Counted found = render("cornell", "wavefront", {{"finish-paths", "0"}});
  const auto bsdf = found.bounces_at("bsdf");
  ASSERT_EQ(bsdf.size(), 5u);
  for (const auto& [bounce, use] : bsdf) {
    EXPECT_EQ(use.lanes, found.bounces_at("shade_surface")[bounce].lanes) << bounce;
    EXPECT_EQ(use.groups, warps_of(use.lanes)) << bounce;
  }
}

TEST_F(CudaDivergence, AnOrderByMaterialFillsWarps) {
  const auto mean_lanes = [](const Settings& more) {
    Settings settings{{"width", "256"}, {"height", "256"}, {"finish-paths", "0"}};
    settings.insert(settings.end(), more.begin(), more.end());
    const Counted found = render("dial:16:0:closed", "wavefront", settings);
    expect_every_ray_once(found);
    return found.at("bsdf").mean_lanes();
  };
  const double mixed = mean_lanes({{"order-surfaces", "off"}});
  const double sorted = mean_lanes({{"order-surfaces", "on"}});
  EXPECT_LT(mixed, 12.0) << "16 materials at random, of at most 13 kinds";
  EXPECT_GT(sorted, 2 * mixed);
}

TEST_F(CudaDivergence, CameraRaysOfFeaturesBelongToNoPath) {
  const Counted found = render("boxes", "wavefront", {{"aov", "albedo,normal"}});
  expect_every_ray_once(found);
}

}  // namespace
}  // namespace pt
