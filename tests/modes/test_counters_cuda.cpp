// Hardware counters of renders: every kernel has them, and the image does not notice.
#include <gtest/gtest.h>

#include <set>

#include "common/device/cuda/counter_session_cuda.h"
#include "cuda_test.h"
#include "mode_cases.h"

namespace pt {
namespace {

class CountersOf : public CudaTest, public testing::WithParamInterface<ImageKind> {
 protected:
  Options options() const {
    Options result = with(Options(), {{"width", "200"}, {"height", "120"}, {"spp", "9"}});
    apply(result, {{"device", "cuda"}, {"scene", "cornell"}, {"max-depth", "6"}});
    apply(result, GetParam().settings);
    return result;
  }
};

const std::vector<ImageKind> kinds{
    {"wavefront", {{"mode", "wavefront"}, {"stages", "split"}, {"finish-paths", "1000"}}},
    {"pool",
     {{"mode", "wavefront"}, {"stages", "split"}, {"pool-size", "20000"}, {"finish-paths", "0"}}},
    {"cub",
     {{"mode", "wavefront"}, {"stages", "split"}, {"compaction", "cub"}, {"finish-paths", "0"}}},
    {"tags", {{"mode", "wavefront"}, {"stages", "split"}, {"compaction", "none"}}},
    {"fused", {{"mode", "wavefront"}, {"stages", "fused"}, {"finish-paths", "1000"}}},
    {"fused_pool",
     {{"mode", "wavefront"}, {"stages", "fused"}, {"pool-size", "20000"}, {"finish-paths", "0"}}},
    {"ordered",
     {{"mode", "wavefront"},
      {"scene", "dial:4:0:closed"},
      {"order-surfaces", "on"},
      {"finish-paths", "0"}}},
    {"persistent",
     {{"mode", "wavefront"}, {"scene", "statue:3K"}, {"accel", "cwbvh"}, {"finish-paths", "0"}}},
    {"xorwow", {{"mode", "wavefront"}, {"rng", "xorwow"}, {"scene", "spheres"}}},
    {"megakernel", {{"mode", "megakernel"}}}};

INSTANTIATE_TEST_SUITE_P(Cuda, CountersOf, testing::ValuesIn(kinds),
                         [](const auto& kind) { return kind.param.name; });

TEST_P(CountersOf, EveryKernelIsCountedAndTheImageStays) {
  const Options chosen = options();
  SCOPED_TRACE(command_of(chosen));
  const DeviceInfo device = choose_device(chosen.device);
  const SceneData scene = make_scene_for(chosen, device);
  const std::unique_ptr<Renderer> renderer = make_renderer(chosen, scene, device);
  const Rendered before = take_image(*renderer);
  HardwareCounters counters;
  try {
    counters = renderer->count_hardware();
  } catch (const CountersUnavailable& error) {
    GTEST_SKIP() << error.what();
  }
  EXPECT_EQ(counters.samples, chosen.spp);
  EXPECT_EQ(counters.rays, before.counts.rays + before.counts.shadow_rays);
  EXPECT_EQ(counters.uncounted_launches, 0u);

  const RenderReport report = report_of(*renderer);
  std::set<std::string> launched, counted;
  for (const KernelInfo& kernel : report.kernels) launched.insert(kernel.name);
  const std::vector<KernelCounters> kernels = sum_by_kernel(counters.launches);
  for (const KernelCounters& kernel : kernels) counted.insert(kernel.kernel);
  counted.erase("compact");  // of a library in part
  launched.erase("compact");
  EXPECT_EQ(counted, launched);

  for (const KernelCounters& kernel : kernels) {
    SCOPED_TRACE(kernel.kernel);
    const CounterRatios ratios = ratios_of(kernel.values, counters.warps_per_sm);
    EXPECT_GT(ratios.threads_per_instruction, 0);
    EXPECT_LE(ratios.threads_per_instruction, 32.001);
    EXPECT_GT(ratios.issue, 0);
    EXPECT_LE(ratios.issue, 1.001);
    EXPECT_GT(ratios.occupancy, 0);
    EXPECT_LE(ratios.occupancy, 1.001);
    EXPECT_GT(value_of(kernel.values, Counter::time_ns), 0);
    EXPECT_GT(value_of(kernel.values, Counter::l2_bytes), 0);
  }
  const KernelCounters all = sum_all(counters.launches);
  EXPECT_GT(value_of(all.values, Counter::dram_read_bytes) +
                value_of(all.values, Counter::dram_written_bytes) +
                value_of(all.values, Counter::l2_bytes),
            0);

  // The device's film is that of the batch that was counted: all samples, and so the same image.
  Rendered again;
  again.image = renderer->image();
  EXPECT_EQ(differing_pixels(again.image, before.image), 0u) << "counting changed the image";
  expect_same(take_image(*renderer), before);
}

struct WaveOfMisses {
  const char *stages, *layout;
  double unmerged;  ///< bytes per new path that half-written sectors may add
};

// Misses only, each new: what a wave moves is known to the byte but for the queues' atomics. Where
// the two halves of a ray share a sector (the layout `sectors`), two instructions write them, and
// L1 does not always merge them into one write of the sector: under load, 0.2 of the sectors are
// written twice on an H100.
TEST_F(CudaTest, CountersOfAWaveOfMissesAreThosePredicted) {
  if (counts_lanes) GTEST_SKIP() << "a build with PTEXP_DIVERGENCE writes its own counts, too";
  const WaveOfMisses cases[] = {
      {"split", "soa", 0}, {"split", "sectors", 32}, {"fused", "soa", 0}, {"fused", "sectors", 0}};
  for (const WaveOfMisses& one : cases) {
    Options options = cuda_options("wavefront", {{"scene", "spheres"},
                                                 {"stages", one.stages},
                                                 {"layout", one.layout},
                                                 {"spheres", "0"},
                                                 {"look-from", "0,10,0"},
                                                 {"look-at", "0,100,1"},
                                                 {"width", "1024"},
                                                 {"height", "1024"},
                                                 {"spp", "4"},
                                                 {"finish-paths", "0"}});
    const DeviceInfo device = choose_device(options.device);
    const SceneData scene = make_scene_for(options, device);
    const std::unique_ptr<Renderer> renderer = make_renderer(options, scene, device);
    const Rendered rendered = take_image(*renderer);
    ASSERT_EQ(rendered.counts.rays, rendered.counts.paths) << "all paths leave the scene";
    HardwareCounters counters;
    try {
      counters = renderer->count_hardware();
    } catch (const CountersUnavailable& error) {
      GTEST_SKIP() << error.what();
    }
    for (const KernelCounters& kernel : sum_by_kernel(counters.launches)) {
      if (kernel.kernel != "generate" && kernel.kernel != "intersect" &&
          kernel.kernel != "shade_miss" && kernel.kernel != "bounce") {
        continue;
      }
      SCOPED_TRACE(std::string(one.stages) + ", " + one.layout + ": " + kernel.kernel);
      const auto& [read, written] = kernel.predicted;
      const bool begins = kernel.kernel == "generate";
      const double unmerged =
          begins ? one.unmerged * static_cast<double>(rendered.counts.paths) : 0.0;
      EXPECT_GT(written, 4e6);
      EXPECT_GE(bytes_from_sm(kernel.values), 0.99 * written);
      EXPECT_LE(bytes_from_sm(kernel.values), 1.1 * written + unmerged);
      EXPECT_NEAR(bytes_to_sm(kernel.values), read, 0.1 * read + 2e6);
    }
  }
}

}  // namespace
}  // namespace pt
