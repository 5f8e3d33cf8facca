// Metropolis light transport on a GPU: one image in both modes, whatever the options that say how,
// and the CPU's in the mean.
#include <gtest/gtest.h>

#include "cuda_test.h"
#include "mode_cases.h"

namespace pt {
namespace {

const Settings few_chains{{"integrator", "mlt"},
                          {"scene", "cornell"},
                          {"width", "67"},
                          {"height", "41"},
                          {"spp", "20"},
                          {"max-depth", "6"},
                          {"chains", "1500"},
                          {"bootstrap", "20000"},
                          {"mutation-size", "0.015625"},
                          {"large-step-probability", "0.3"}};

Rendered render_mlt(const std::string& mode, const Settings& more) {
  return render_options(with(cuda_options(mode, few_chains), more));
}

void expect_same_chains(const Rendered& found, const Rendered& expected) {
  expect_same(found, expected);
  EXPECT_EQ(found.run.metropolis->brightness, expected.run.metropolis->brightness);
  EXPECT_EQ(found.run.metropolis->large_acceptance, expected.run.metropolis->large_acceptance);
  EXPECT_EQ(found.run.metropolis->small_acceptance, expected.run.metropolis->small_acceptance);
}

class GpuMetropolis : public CudaTest, public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Cuda, GpuMetropolis, testing::Values("cornell", "spheres", "boxes"));

TEST_P(GpuMetropolis, OneImageInBothModes) {
  const auto also = [](Settings more) {
    more.emplace_back("scene", GetParam());
    return more;
  };
  const Rendered expected = render_mlt("megakernel", also({}));
  const MetropolisStats& stats = *expected.run.metropolis;
  EXPECT_EQ(stats.mutations, 37u * 1500u);  // 67 x 41 x 20, rounded up to whole iterations
  EXPECT_EQ(expected.counts.paths, 20000u + 38u * 1500u);
  EXPECT_GT(stats.small_acceptance, 0.5);
  EXPECT_LT(stats.small_acceptance, 0.99);
  EXPECT_GT(stats.large_acceptance, 0.05);
  EXPECT_LT(stats.large_acceptance, 0.95);
  EXPECT_NEAR(stats.large_share, 0.3, 0.02);
  for (const std::string& work : names_of(Work::persistent)) {
    for (const char* block : {"16x16", "32x4", "5x3"}) {
      SCOPED_TRACE(testing::Message() << work << " " << block);
      expect_same_chains(render_mlt("megakernel", also({{"work", work}, {"block", block}})),
                         expected);
    }
  }
  const std::vector<Choice> choices{{"compaction", names_of(Compaction::atomic)},
                                    {"order-surfaces", {"auto", "on"}},
                                    {"schedule", names_of(Schedule::graph, {Schedule::automatic})},
                                    {"pool-size", {"auto", "700", "20000", "1M"}},
                                    {"finish-paths", {"131072", "0", "300"}},
                                    {"stages", {"split", "fused"}},
                                    {"stage-block", {"256", "33", "128,shade_surface=64"}},
                                    {"layout", names_of(PoolLayout::sectors)}};
  for (const Settings& settings : variations(choices, 8, 5)) {
    const Options options = with(cuda_options("wavefront", few_chains), also(settings));
    SCOPED_TRACE(command_of(options));
    expect_same_chains(render_options(options), expected);
    if (HasFailure()) return;
  }
}

TEST_F(CudaTest, MetropolisAgreesWithTheCpuInTheMean) {
  const Settings image{{"width", "32"}, {"height", "24"}, {"spp", "1000"}, {"bootstrap", "1M"}};
  MeanEstimate cpu, gpu;
  for (int seed = 1; seed <= 8; ++seed) {
    Settings settings = image;
    settings.emplace_back("seed", std::to_string(seed));
    const auto mean = [](const Image& picture) {
      double sum = 0;
      for (const float value : picture.rgb) sum += value;
      return sum / static_cast<double>(picture.rgb.size());
    };
    gpu.add(mean(render_mlt("wavefront", settings).image));
    Options path = with(with(Options(), few_chains), settings);
    apply(path,
          {{"device", "cpu"}, {"mode", "megakernel"}, {"integrator", "path"}, {"spp", "200"}});
    cpu.add(mean(render_options(path).image));
  }
  EXPECT_LT(std::abs(gpu.mean() - cpu.mean()), 5.5 * std::hypot(gpu.sigma(), cpu.sigma()));
  EXPECT_LT(gpu.sigma(), 0.01 * gpu.mean());
}

// Many chains for few mutations, one chain, and the renders of one renderer after each other.
TEST_F(CudaTest, MetropolisTakesAnyNumberOfChains) {
  for (const char* chains : {"1", "100000", "auto"}) {
    const Settings settings{{"chains", chains}, {"spp", "1"}, {"bootstrap", "1000"}};
    SCOPED_TRACE(chains);
    expect_same_chains(render_mlt("wavefront", settings), render_mlt("megakernel", settings));
  }
  const Options options = with(cuda_options("wavefront", few_chains), {});
  const DeviceInfo device = choose_device(options.device);
  const SceneData scene = make_scene_for(options, device);
  const auto renderer = make_renderer(options, scene, device);
  const Rendered first = take_image(*renderer);
  expect_same_chains(take_image(*renderer), first);
}

}  // namespace
}  // namespace pt
