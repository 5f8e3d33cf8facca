// The megakernel whose blocks sort their paths, on emulated blocks: each path gets what it gets
// when it is followed alone, bit for bit.
#include <gtest/gtest.h>

#include "common/render/path_limits_of.h"
#include "common/render/random_source.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/transport/follow_path.h"
#include "emulated_gpu.h"  // before device code
#include "megakernel/trace_paths_sorting.cuh"
#include "mode_cases.h"
#include "scene/masked_room.h"

namespace pt {
namespace {

template <bool has_masks>
using BlockWavefrontTraits = Traits<Accel::cwbvh, Geometry::triangles, Lighting::full, has_masks>;
constexpr int threads = 64;

/// What blocks made of the paths of a scene, and what each is alone.
class SortedPaths {
 public:
  SortedPaths(const SceneData& scene, const Options& options)
      : scene_(host_view(scene, options.width, options.height)),
        source_(sampler_source_of(options)),
        limits_(path_limits_of(options)) {
    scene_.mask_seed = mask_seed(options.seed);
    const auto width = static_cast<std::uint32_t>(options.width);
    const auto height = static_cast<std::uint32_t>(options.height);
    const auto spp = static_cast<std::uint32_t>(options.spp);
    samples_.resize(std::size_t{width} * height * spp, Sample{Color(-1.0f), 0});
    batch_ = SampleBuffer(samples_.data(), {0, 0, width, height}, 0, spp);
  }

  /// What a grid of blocks does, one after the other; later ones may find nothing left. Beyond what
  /// a block may use of its memory nothing is written.
  template <class Traits>
  void sort(int blocks, std::uint32_t at_once,
            int slots_per_thread = BlockWavefrontTuning::slots_most) {
    using Memory = BlockWavefrontMemory<BlockWavefrontLane<Traits>, threads>;
    const auto memory = std::make_unique<Memory>();
    std::vector<PathSlot> slots(std::size_t{threads} * slots_per_thread);
    std::uint32_t next_path = 0;
    const PathShare paths{&next_path, at_once, slots_per_thread};
    const auto* const bytes = reinterpret_cast<const unsigned char*>(memory.get());
    for (int i = 0; i < blocks; ++i) {
      std::memset(static_cast<void*>(memory.get()), 0xa5, sizeof *memory);
      EmulatedBlock(threads).run([&] {
        uint2 stack[block_wavefront_stack_size];
        BlockWavefront<Traits, SamplerSource, Memory> tracer(scene_, source_, batch_, limits_,
                                                             paths, *memory, slots.data(), stack);
        tracer.run();
      });
      ASSERT_TRUE(std::all_of(bytes + Memory::bytes(slots_per_thread), bytes + sizeof *memory,
                              [](unsigned char byte) { return byte == 0xa5; }));
    }
  }

  template <class Traits>
  void expect_what_each_gets_alone() const {
    int lit = 0;
    for (std::uint32_t path_index = 0; path_index < batch_.path_count; ++path_index) {
      const Sample expected = follow<Traits>(path_index), found = samples_[path_index];
      ASSERT_EQ(found.rays, expected.rays) << "path " << path_index;
      ASSERT_EQ(std::memcmp(&found, &expected, sizeof found), 0) << "path " << path_index;
      lit += is_black(expected.radiance) ? 0 : 1;
    }
    EXPECT_GT(lit, 0);
  }

 private:
  template <class Traits>
  Sample follow(std::uint32_t path_index) const {
    const PathId id = batch_.id_of(path_index);
    auto random = source_.open(id);
    PathState path;
    path.index = path_index;
    const Vec4 u = random.draw(scatter_block(0));
    const Ray ray = generate_camera_path(scene_, random, id.pixel, u);
    const Color radiance = follow_path<Traits>(scene_, ray, path, Color(0.0f), limits_, random,
                                               mask_key<Traits>(scene_, id));
    return {radiance, path.packed_rays()};
  }

  Scene scene_;
  SamplerSource source_;
  PathLimits limits_;
  std::vector<Sample> samples_;
  SampleBuffer batch_;
};

Options small_image() {
  return with(
      Options(),
      {{"width", "19"}, {"height", "11"}, {"spp", "2"}, {"max-depth", "5"}, {"accel", "cwbvh"}});
}

class SortingOf : public testing::TestWithParam<ImageKind> {};

INSTANTIATE_TEST_SUITE_P(
    Emulated, SortingOf,
    testing::Values(ImageKind{"boxes", {{"scene", "boxes"}}},
                    ImageKind{"statue", {{"scene", "statue:3K"}}},
                    ImageKind{"many_kinds", {{"scene", "dial:14:0:closed"}}},
                    ImageKind{"long_paths", {{"scene", "dial:6:0:closed"}, {"max-depth", "30"}}},
                    ImageKind{"roulette", {{"scene", "boxes"}, {"rr", "2"}, {"max-depth", "20"}}},
                    ImageKind{"light_tree", {{"scene", "boxes"}, {"light-selection", "tree"}}},
                    ImageKind{"no_light_sampling", {{"scene", "boxes"}, {"nee", "off"}}},
                    ImageKind{"camera_rays", {{"scene", "boxes"}, {"max-depth", "1"}}},
                    ImageKind{"one_path", {{"scene", "boxes"}, {"width", "1"}, {"height", "1"}}}),
    [](const auto& kind) { return kind.param.name; });

TEST_P(SortingOf, GivesEachPathWhatItGetsAlone) {
  using Traits = BlockWavefrontTraits<false>;
  const Options options = with(small_image(), GetParam().settings);
  const SceneData scene = make_scene_for(options, choose_device({DeviceChoice::Kind::cpu}));
  ASSERT_EQ(scene.traits, Traits::value());
  SortedPaths paths(scene, options);
  paths.sort<Traits>(2, 100);
  paths.expect_what_each_gets_alone<Traits>();
}

TEST(SortingOfFewSlots, GivesEachPathWhatItGetsAlone) {
  using Traits = BlockWavefrontTraits<false>;
  const Options options = with(small_image(), {{"scene", "boxes"}});
  const SceneData scene = make_scene_for(options, choose_device({DeviceChoice::Kind::cpu}));
  for (const int slots_per_thread : {1, 4, 7}) {
    SortedPaths paths(scene, options);
    paths.sort<Traits>(2, 300, slots_per_thread);
    paths.expect_what_each_gets_alone<Traits>();
  }
}

TEST(SortingOfMasks, GivesEachPathWhatItGetsAlone) {
  const Options options = with(small_image(), {{"width", "31"}, {"height", "23"}});
  SceneData scene = masked_room();
  prepare_scene(scene, options);
  ASSERT_TRUE(scene.traits.has_masks);
  SortedPaths paths(scene, options);
  paths.sort<BlockWavefrontTraits<true>>(1, 31 * 23 * 2);
  paths.expect_what_each_gets_alone<BlockWavefrontTraits<true>>();
}

}  // namespace
}  // namespace pt
