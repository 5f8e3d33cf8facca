// Scenes of triangles give one image in all modes, bit for bit: what a path is, and what it met,
// must survive the wavefront's pool. With --finish-paths 0 no path is finished without it.
#include "mode_cases.h"

namespace pt {
namespace {

class TriangleModesOf : public testing::TestWithParam<const char*> {
 protected:
  static Options options(const Settings& more) {
    const Settings small{{"device", "cpu"}, {"scene", GetParam()}, {"width", "40"},
                         {"height", "30"},  {"spp", "3"},          {"max-depth", "6"}};
    return with(with(Options(), small), more);
  }
};
INSTANTIATE_TEST_SUITE_P(Scenes, TriangleModesOf,
                         testing::Values("boxes", "instances:20", "statue:3K",
                                         "dial:16:0.5:closed"),
                         [](const auto& scene) {
                           const std::string name = scene.param;
                           return name.substr(0, name.find(':'));
                         });

TEST_P(TriangleModesOf, MegakernelAndWavefrontEqualSerial) {
  const Options serial = options({{"mode", "serial"}});
  expect_all_same(options({{"mode", "megakernel"}}),
                  variations({{"accel", structures(AccelKind::cwbvh, {AccelKind::brute})},
                              {"threads", {"2", "1"}}},
                             0, 1),
                  serial);
  const std::vector<Choice> choices{{"accel", structures(AccelKind::cwbvh, {AccelKind::brute})},
                                    {"compaction", names_of(Compaction::atomic)},
                                    {"order-surfaces", {"auto", "on"}},
                                    {"pool-size", {"333", "33", "auto", "3600"}},
                                    {"regenerate", {"on", "off"}},
                                    {"layout", names_of(PoolLayout::soa)},
                                    {"finish-paths", {"0", "100"}}};
  expect_all_same(options({{"mode", "wavefront"}}), variations(choices, 2, 3), serial);
  const std::vector<Choice> fused{{"accel", structures(AccelKind::bvh2, {AccelKind::brute})},
                                  {"compaction", names_of(Compaction::atomic)},
                                  {"pool-size", {"333", "auto", "3600"}},
                                  {"regenerate", {"on", "off"}},
                                  {"layout", names_of(PoolLayout::soa)},
                                  {"wave-rays", {"1", "2"}},
                                  {"finish-paths", {"0", "100"}}};
  expect_all_same(options({{"mode", "wavefront"}, {"stages", "fused"}}), variations(fused, 2, 4),
                  serial);
}

}  // namespace
}  // namespace pt
