// Every BSDF, with and without masks: all modes of the CPU give one image, bit for bit.
#include "common/scene/prepare/prepare_scene.h"
#include "mode_cases.h"
#include "scene/masked_room.h"
#include "scene/material_room.h"

namespace pt {
namespace {

class MaterialModes : public testing::TestWithParam<SceneData (*)()> {};
INSTANTIATE_TEST_SUITE_P(Rooms, MaterialModes,
                         testing::Values([] { return material_room(false); },
                                         [] { return material_room(true); }, masked_room));

TEST_P(MaterialModes, EqualSerial) {
  const auto render = [](const Settings& settings) {
    Options options = with(
        Options(),
        {{"device", "cpu"}, {"width", "45"}, {"height", "41"}, {"spp", "4"}, {"max-depth", "6"}});
    apply(options, settings);
    SceneData scene = GetParam()();
    prepare_scene(scene, options);
    return take_image(*make_renderer(options, scene, choose_device(options.device)));
  };
  const Rendered serial = render({{"mode", "serial"}});
  EXPECT_EQ(serial.counts.nonfinite_samples, 0u);
  expect_same(render({{"mode", "megakernel"}}), serial);
  for (const std::string& accel : structures(AccelKind::bvh2)) {
    expect_same(render({{"mode", "wavefront"}, {"accel", accel}, {"finish-paths", "0"}}), serial);
  }
  for (const Settings& ordered :
       {Settings{{"order-surfaces", "on"}},
        Settings{{"order-surfaces", "on"}, {"compaction", "cub"}, {"layout", "aos"}}}) {
    Settings wavefront{{"mode", "wavefront"}, {"finish-paths", "0"}, {"pool-size", "1000"}};
    wavefront.insert(wavefront.end(), ordered.begin(), ordered.end());
    expect_same(render(wavefront), serial);
  }
  for (const char* accel : {"bvh2", "brute"}) {
    expect_same(render({{"mode", "wavefront"},
                        {"accel", accel},
                        {"stages", "fused"},
                        {"finish-paths", "0"},
                        {"pool-size", "1000"}}),
                serial);
  }
}

}  // namespace
}  // namespace pt
