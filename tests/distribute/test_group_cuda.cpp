// Several renderers of CUDA make the image of one, also where they share a device.
#include <fmt/format.h>

#include "app/render/rendering.h"
#include "common/film/develop.h"
#include "cuda_test.h"
#include "film_cases.h"

namespace pt {
namespace {

class DevicesOf : public CudaTest, public testing::WithParamInterface<Settings> {};
INSTANTIATE_TEST_SUITE_P(
    Cuda, DevicesOf,
    testing::Values(Settings{{"scene", "spheres"}, {"mode", "megakernel"}},
                    Settings{{"scene", "spheres"}, {"rng", "xorwow"}},
                    Settings{{"scene", "boxes"}, {"aov", "albedo,depth,primitive,variance,rays"}},
                    Settings{{"scene", "boxes"}, {"mode", "megakernel"}, {"crop", "30,5,200,99"}},
                    Settings{{"scene", "instances:20"}, {"filter", "mitchell"}},
                    Settings{{"scene", "statue:20K"}, {"builder", "hploc"}}));

TEST_P(DevicesOf, SeveralMakeTheImageOfOne) {
  const Options options = with(with(Options(), {{"device", "cuda"},
                                                {"width", "240"},
                                                {"height", "160"},
                                                {"spp", "40"},
                                                {"max-depth", "6"}}),
                               GetParam());
  const DeviceInfo device = choose_device(options.device);
  const SceneData scene = make_scene_for(options, device);
  Film expected;
  expected.window = window_of(options);
  {
    const auto single = make_renderer(options, scene, device);
    single->render(expected, options.spp, {});
  }
  // All that there are, and the first one twice.
  std::vector<DeviceInfo> devices = choose_devices({DeviceChoice::Kind::cuda, 0, {}, true}, 0);
  devices.push_back(device);
  const auto bell = std::make_shared<ResultBell>();
  GroupRenderer group(options, scene.filter,
                      make_workers(plan_render(options, scene, devices), scene, devices, *bell),
                      bell);
  const RenderRun run = group.render(RenderHooks{});
  EXPECT_EQ(run.samples_done, 40);
  Film whole = group.film().take(expected.window);
  whole.tally = group.film().tally;
  EXPECT_EQ(differing_sums(whole, expected), 0u);
  expect_same_counts(summarize(whole.tally), summarize(expected.tally));
  RenderReport report;
  group.describe(report);
  EXPECT_NE(report.device_name.find(fmt::format("{} x ", devices.size())), std::string::npos)
      << report.device_name;
}

}  // namespace
}  // namespace pt
