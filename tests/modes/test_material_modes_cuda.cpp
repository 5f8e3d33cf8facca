// Every BSDF, with and without masks, and lights of all kinds: on a GPU both modes give one image,
// bit for bit, and one that is close to the CPU's.
#include "common/image/compare.h"
#include "common/scene/prepare_scene.h"
#include "cuda_test.h"
#include "lit_room.h"
#include "material_room.h"
#include "mode_cases.h"

namespace pt {
namespace {

struct Room {
  const char* name;
  SceneData (*make)();
};

void PrintTo(const Room& room, std::ostream* out) { *out << room.name; }

class GpuRoomsOf : public CudaTest, public testing::WithParamInterface<Room> {
 protected:
  static Rendered render(const Settings& settings) {
    Options options =
        with(Options(), {{"width", "45"}, {"height", "41"}, {"spp", "4"}, {"max-depth", "6"}});
    apply(options, settings);
    SceneData scene = GetParam().make();
    prepare_scene(scene, options);
    return take_image(*make_renderer(options, scene, choose_device(options.device)));
  }
};
INSTANTIATE_TEST_SUITE_P(Cuda, GpuRoomsOf,
                         testing::Values(Room{"materials", [] { return material_room(false); }},
                                         Room{"masked_materials",
                                              [] { return material_room(true); }},
                                         Room{"lights", lit_room}),
                         [](const auto& room) { return room.param.name; });

TEST_P(GpuRoomsOf, WavefrontEqualsMegakernel) {
  const Rendered expected = render({{"device", "cuda"}, {"mode", "megakernel"}});
  EXPECT_EQ(expected.counts.nonfinite_samples, 0u);
  for (const char* accel : {"bvh2", "cwbvh", "brute"}) {
    for (const char* compaction : {"atomic", "cub", "none"}) {
      for (const char* finish : {"0", "131072"}) {
        if (std::string(accel) == "brute" && GetParam().name == std::string("masked_materials")) {
          continue;  // brute force has no masks on CUDA
        }
        SCOPED_TRACE(testing::Message() << accel << ", " << compaction << ", " << finish);
        expect_same(render({{"device", "cuda"},
                            {"mode", "wavefront"},
                            {"accel", accel},
                            {"compaction", compaction},
                            {"finish-paths", finish}}),
                    expected);
      }
    }
  }
}

// By default a scene of several kinds is shaded by kind.
TEST_P(GpuRoomsOf, OrderedSurfacesEqualMegakernel) {
  const Rendered expected = render({{"device", "cuda"}, {"mode", "megakernel"}});
  for (const char* shade : {"uber", "material", "auto"}) {
    for (const char* compaction : {"atomic", "cub", "sort"}) {
      for (const char* pool : {"1000", "auto"}) {
        SCOPED_TRACE(testing::Message() << shade << ", " << compaction << ", " << pool);
        expect_same(render({{"device", "cuda"},
                            {"mode", "wavefront"},
                            {"shade", shade},
                            {"compaction", compaction},
                            {"pool-size", pool},
                            {"finish-paths", "0"}}),
                    expected);
      }
    }
  }
}

TEST_P(GpuRoomsOf, AreCloseToTheCpu) {
  const Settings many{{"spp", "64"}};
  Settings cuda = many, cpu = many;
  cuda.emplace_back("device", "cuda");
  cpu.insert(cpu.end(), {{"device", "cpu"}, {"mode", "megakernel"}});
  const Image a = render(cuda).image, b = render(cpu).image;
  double sum_a = 0, sum_b = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) sum_a += a.rgb[i], sum_b += b.rgb[i];
  EXPECT_NEAR(sum_a / sum_b, 1.0, 5e-3);
}

}  // namespace
}  // namespace pt
