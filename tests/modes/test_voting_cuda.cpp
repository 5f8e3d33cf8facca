// The megakernel whose warps vote gives the image of the loop, bit for bit, and traces the same
// rays.
#include <gtest/gtest.h>

#include <algorithm>

#include "common/error.h"
#include "cuda_test.h"
#include "mode_cases.h"

namespace pt {
namespace {

/// With a wide tree; odd sizes, no multiple of what a warp fetches.
std::vector<ImageKind> voting_kinds() {
  const Settings usual{{"width", "67"},    {"height", "41"},   {"spp", "5"},
                       {"scene", "boxes"}, {"max-depth", "6"}, {"accel", "cwbvh"}};
  const std::vector<std::pair<std::string, Settings>> changes{
      {"boxes", {}},
      {"statue", {{"scene", "statue:3K"}}},
      {"terrain", {{"scene", "terrain:3K"}}},
      {"dial", {{"scene", "dial:6:0:closed"}}},
      {"cornell", {{"scene", "cornell"}, {"sampler", "sobol"}}},
      {"one_path", {{"width", "1"}, {"height", "1"}, {"spp", "1"}}},
      {"one_column", {{"width", "1"}, {"height", "37"}, {"spp", "1"}}},
      {"less_than_a_warp", {{"width", "5"}, {"height", "3"}, {"spp", "2"}}},
      {"depth_1", {{"max-depth", "1"}}},
      {"depth_2", {{"max-depth", "2"}}},
      {"depth_50", {{"max-depth", "50"}, {"spp", "2"}}},
      {"roulette", {{"rr", "3"}, {"max-depth", "20"}}},
      {"no_light_sampling", {{"nee", "off"}}},
      {"light_tree", {{"light-selection", "tree"}}},
      {"balance", {{"mis", "balance"}}},
      {"cosine", {{"sampling", "cosine"}}},
      {"stratified", {{"sampler", "stratified"}}},
      {"mitchell", {{"filter", "mitchell"}}},
      {"crop", {{"crop", "11,7,40,38"}}},
      {"hploc", {{"scene", "statue:3K"}, {"builder", "hploc"}}},
      {"chains",
       {{"scene", "boxes"}, {"integrator", "mlt"}, {"chains", "700"}, {"bootstrap", "5000"}}}};
  std::vector<ImageKind> kinds;
  for (const auto& [name, change] : changes) {
    kinds.push_back({name, usual});
    kinds.back().settings.insert(kinds.back().settings.end(), change.begin(), change.end());
  }
  return kinds;
}

class GpuVotingOf : public CudaTest, public testing::WithParamInterface<ImageKind> {
 protected:
  Rendered render(const std::string& mode, const Settings& more = {}) const {
    const Options options = with(cuda_options(mode, GetParam().settings), more);
    SCOPED_TRACE(command_of(options));
    return render_options(options);
  }
};
INSTANTIATE_TEST_SUITE_P(Cuda, GpuVotingOf, testing::ValuesIn(voting_kinds()),
                         [](const auto& kind) { return kind.param.name; });

// The first render is the vote's: its samples cannot be what another left in the memory.
TEST_P(GpuVotingOf, EqualsTheLoopAndTheWavefront) {
  const Rendered voted = render("megakernel", {{"kernel", "vote"}});
  const Rendered expected = render("megakernel", {{"kernel", "loop"}});
  EXPECT_GT(expected.counts.rays, 0u);
  expect_same(voted, expected);
  expect_same(render("wavefront"), expected);
}

TEST_P(GpuVotingOf, DoesNotDependOnTheBlock) {
  const Rendered expected = render("megakernel", {{"kernel", "loop"}});
  Rendered other_seed = render("megakernel", {{"kernel", "loop"}, {"seed", "2"}});
  for (const char* block : {"32x1", "1x32", "8x8", "3x32", "32x4", "16x16", "1x256"}) {
    SCOPED_TRACE(block);
    expect_same(render("megakernel", {{"kernel", "vote"}, {"block", block}}), expected);
    expect_same(render("megakernel", {{"kernel", "vote"}, {"block", block}, {"seed", "2"}}),
                other_seed);
  }
}

class CudaVoting : public CudaTest {
 protected:
  /// What the megakernel is launched with.
  static KernelInfo kernel_of(const Settings& settings) {
    const Options options = cuda_options("megakernel", with_image(settings));
    const DeviceInfo device = choose_device(options.device);
    const SceneData scene = make_scene_for(options, device);
    const auto renderer = make_renderer(options, scene, device);
    renderer->render({});
    RenderReport report;
    renderer->describe(report);
    const auto kernel = std::ranges::find(report.kernels, "megakernel", &KernelInfo::name);
    return kernel != report.kernels.end() ? *kernel : KernelInfo{};
  }

  static Settings with_image(Settings settings) {
    settings.insert(settings.begin(), {{"width", "32"}, {"height", "16"}, {"spp", "1"}});
    return settings;
  }
};

// Warps that vote keep their paths in shared memory, and the loop nothing.
TEST_F(CudaVoting, IsChosenWhereItApplies) {
  const auto votes = [](const Settings& settings) { return kernel_of(settings).shared_bytes > 0; };
  EXPECT_TRUE(votes({{"scene", "boxes"}, {"kernel", "vote"}}));
  EXPECT_TRUE(votes({{"scene", "boxes"}, {"accel", "cwbvh"}}));
  EXPECT_FALSE(votes({{"scene", "boxes"}, {"accel", "cwbvh"}, {"kernel", "loop"}}));
  EXPECT_FALSE(votes({{"scene", "boxes"}, {"accel", "cwbvh"}, {"work", "sample"}}));
  EXPECT_FALSE(votes({{"scene", "boxes"}, {"accel", "cwbvh"}, {"block", "5x3"}}));
  EXPECT_FALSE(votes({{"scene", "boxes"}, {"accel", "cwbvh"}, {"block", "32x32"}}));
  EXPECT_FALSE(votes({{"scene", "instances:20"}, {"accel", "cwbvh"}}));
  EXPECT_FALSE(votes({{"scene", "boxes"}, {"accel", "bvh2"}}));
  EXPECT_FALSE(votes({{"scene", "cornell"}}));
}

TEST_F(CudaVoting, RefusesBlocksThatAreTooLarge) {
  const std::string refusal = refusal_of({{"device", "cuda"},
                                          {"mode", "megakernel"},
                                          {"scene", "boxes"},
                                          {"kernel", "vote"},
                                          {"block", "32x16"}});
  EXPECT_NE(refusal.find("--kernel vote: expected"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("32x16 has 512"), std::string::npos) << refusal;
}

// Warps that fetch paths again in the middle of a request: more of them than all fetch at first.
TEST_F(CudaVoting, WarpsTakeEveryPath) {
  cudaDeviceProp device{};
  check_cuda(cudaGetDeviceProperties(&device, choose_device({}).choice.index),
             "cudaGetDeviceProperties");
  constexpr int fetched = 128, side = 256;
  const int warps = device.multiProcessorCount * device.maxThreadsPerMultiProcessor / 32;
  Options options = cuda_options("megakernel", {{"scene", "boxes"},
                                                {"accel", "cwbvh"},
                                                {"width", "256"},
                                                {"height", "256"},
                                                {"max-depth", "4"}});
  options.spp = 2 * warps * fetched / (side * side) + 1;
  expect_all_same(options, variations({{"kernel", {"vote", "loop"}}}, 0, 0),
                  with(options, {{"kernel", "loop"}, {"work", "pixel"}}));
}

}  // namespace
}  // namespace pt
