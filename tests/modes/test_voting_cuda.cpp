// The megakernels whose warps vote and whose blocks sort give the image of the loop, bit for bit,
// and trace the same rays.
#include <gtest/gtest.h>

#include <algorithm>

#include "common/error/error.h"
#include "common/scene/prepare/prepare_scene.h"
#include "cuda_test.h"
#include "mode_cases.h"
#include "scene/masked_room.h"

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
      {"all_kinds", {{"scene", "dial:14:0.5:open"}}},
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

// The first renders are theirs: their samples cannot be what another left in the memory.
TEST_P(GpuVotingOf, EqualsTheLoopAndTheWavefront) {
  const Rendered sorted = render("megakernel", {{"kernel", "sort"}, {"seed", "3"}});
  const Rendered voted = render("megakernel", {{"kernel", "vote"}});
  const Rendered expected = render("megakernel", {{"kernel", "loop"}});
  EXPECT_GT(expected.counts.rays, 0u);
  expect_same(voted, expected);
  expect_same(render("wavefront"), expected);
  expect_same(sorted, render("megakernel", {{"kernel", "loop"}, {"seed", "3"}}));
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
    const RenderReport report = report_of(cuda_options("megakernel", with_image(settings)));
    const auto kernel = std::ranges::find(report.kernels, "megakernel", &KernelInfo::name);
    return kernel != report.kernels.end() ? *kernel : KernelInfo{};
  }

  static Settings with_image(Settings settings) {
    settings.insert(settings.begin(), {{"width", "32"}, {"height", "16"}, {"spp", "1"}});
    return settings;
  }
};

// Warps that vote and blocks that sort keep paths in shared memory, and the loop nothing; blocks
// that sort have a size of their own.
TEST_F(CudaVoting, IsChosenWhereItApplies) {
  const auto kind_of = [](const Settings& settings) {
    const KernelInfo kernel = kernel_of(settings);
    if (kernel.block_threads == 640) return "sort";
    return kernel.shared_bytes > 0 ? "vote" : "loop";
  };
  const auto with_wide_tree = [&](Settings settings) {
    settings.emplace_back("accel", "cwbvh");
    return kind_of(settings);
  };
  EXPECT_STREQ(kind_of({{"scene", "boxes"}, {"kernel", "vote"}}), "vote");
  EXPECT_STREQ(kind_of({{"scene", "boxes"}, {"kernel", "sort"}}), "sort");
  EXPECT_STREQ(kind_of({{"scene", "boxes"}}), "sort");
  EXPECT_STREQ(kind_of({{"scene", "dial:2"}}), "sort");
  EXPECT_STREQ(kind_of({{"scene", "boxes"}, {"block", "32x4"}}), "vote");
  EXPECT_STREQ(kind_of({{"scene", "dial:2"}, {"block", "32x4"}}), "loop");
  EXPECT_STREQ(kind_of({{"scene", "boxes"}, {"accel", "bvh2"}}), "loop");
  EXPECT_STREQ(kind_of({{"scene", "cornell"}}), "loop");
  EXPECT_STREQ(with_wide_tree({{"scene", "dial:2"}}), "sort");
  EXPECT_STREQ(with_wide_tree({{"scene", "dial:2"}, {"block", "32x4"}}), "vote");
  EXPECT_STREQ(with_wide_tree({{"scene", "boxes"}, {"kernel", "loop"}}), "loop");
  EXPECT_STREQ(with_wide_tree({{"scene", "boxes"}, {"work", "sample"}}), "loop");
  EXPECT_STREQ(with_wide_tree({{"scene", "boxes"}, {"block", "5x3"}}), "loop");
  EXPECT_STREQ(with_wide_tree({{"scene", "boxes"}, {"block", "32x32"}}), "loop");
  EXPECT_STREQ(kind_of({{"scene", "instances:20"}}), "sort");
  EXPECT_STREQ(kind_of({{"scene", "instances:20"}, {"block", "32x4"}}), "loop");
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

// The loop traces a binary tree.
TEST_F(CudaVoting, BlocksThatSortAskMasks) {
  const auto render = [](const char* kernel, const char* accel) {
    const Options options = cuda_options("megakernel", {{"width", "67"},
                                                        {"height", "41"},
                                                        {"spp", "5"},
                                                        {"max-depth", "8"},
                                                        {"kernel", kernel},
                                                        {"accel", accel}});
    SceneData scene = masked_room();
    prepare_scene(scene, options);
    EXPECT_TRUE(scene.traits.has_masks);
    return take_image(*make_renderer(options, scene, choose_device(options.device)));
  };
  const Rendered expected = render("loop", "bvh2");
  EXPECT_GT(expected.counts.shadow_rays, 0u);
  expect_same(render("sort", "cwbvh"), expected);
  expect_same(render("auto", "auto"), expected);
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
  expect_all_same(options, variations({{"kernel", {"vote", "sort", "loop"}}}, 0, 0),
                  with(options, {{"kernel", "loop"}, {"work", "pixel"}}));
}

}  // namespace
}  // namespace pt
