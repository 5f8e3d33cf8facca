// Block-local wavefronts, on emulated blocks: each path gets what it gets when it is followed
// alone, bit for bit, from its first ray on or from where the waves have left it.
#include <gtest/gtest.h>

// The emulation comes before what it emulates.
// clang-format off
#include "emulated_gpu.h"
#include "common/block_wavefront/block_wavefront.cuh"
// clang-format on
#include "common/render/settings_of.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/transport/follow_path.h"
#include "medium/filled_glasses.h"
#include "mode_cases.h"
#include "scene/masked_room.h"
#include "wavefront/stages.h"

namespace pt {
namespace {

template <Geometry geometry, bool has_masks = false, bool has_media = false>
using BlockWavefrontTraits = Traits<Accel::cwbvh, geometry, Lighting::full, has_masks, has_media>;
using PlainTraits = BlockWavefrontTraits<Geometry::triangles>;
using MaskedTraits = BlockWavefrontTraits<Geometry::triangles, true>;
using MediaTraits = BlockWavefrontTraits<Geometry::triangles, true, true>;
using InstancedTraits = BlockWavefrontTraits<Geometry::mixed>;
constexpr int threads = 64;

/// What blocks made of the paths of a scene, and what each is alone.
class SortedPaths {
 public:
  SortedPaths(const SceneData& scene, const Options& options)
      : scene_(host_view(scene, options.width, options.height)),
        source_(sampler_source_of(options)),
        path_settings_(path_settings_of(options, options.path_bytes)) {
    scene_.mask_seed = mask_seed(options.seed);
    const auto width = static_cast<std::uint32_t>(options.width);
    const auto height = static_cast<std::uint32_t>(options.height);
    const auto spp = static_cast<std::uint32_t>(options.spp);
    samples_.resize(std::size_t{width} * height * spp, Sample{Color(-1.0f), 0});
    batch_ = SampleBuffer(samples_.data(), {0, 0, width, height}, 0, spp);
  }

  /// All paths, by a grid of blocks; later ones may find nothing left.
  template <class Traits>
  void sort(int blocks, std::uint32_t at_once,
            int slots_per_thread = BlockWavefrontTuning::slots_most) {
    run<Traits>(blocks, at_once, slots_per_thread,
                BegunPaths::divide(make_slots<Traits>(blocks, slots_per_thread), 0, blocks));
  }

  /// Follows each path alone for `rays` rays, and hands those that are left over to blocks.
  template <class Traits>
  void finish(int rays, int blocks, int slots_per_thread) {
    PathPool pool;
    pool.slot_count = batch_.path_count;
    std::vector<std::vector<std::uint64_t>> arrays;
    PathPool::Fields fields{true, false, false, scene_.light_selector.has_tree()};
    fields.media = Traits::has_media;
    fields.extra_records = path_settings_.extra_records;
    pool.allocate_arrays(fields, [&]<class T>(T*, std::uint64_t count) {
      arrays.emplace_back(count * sizeof(T) / sizeof(std::uint64_t) + 1);
      return reinterpret_cast<T*>(arrays.back().data());
    });
    const std::vector<std::uint32_t> left = begin<Traits>(pool, rays);
    ASSERT_GT(left.size(), 0u);
    const BegunPaths begun = BegunPaths::divide(make_slots<Traits>(blocks, slots_per_thread),
                                                static_cast<std::uint32_t>(left.size()), blocks);
    ASSERT_LE(begun.per_block, begun.slots.per_block);
    for (std::uint32_t rank = 0; rank < left.size(); ++rank)
      HandOver<true>{pool, batch_, begun}(scene_, left[rank], rank);
    run<Traits>(blocks, 0, slots_per_thread, begun);
  }

  template <class Traits>
  void expect_what_each_gets_alone() const {
    int lit = 0;
    for (std::uint32_t path_index = 0; path_index < batch_.path_count; ++path_index) {
      const Sample expected = follow<Traits>(path_index), found = samples_[path_index];
      ASSERT_EQ(found.rays, expected.rays) << "path " << path_index;
      ASSERT_TRUE(is_finite(expected.radiance)) << "path " << path_index;
      ASSERT_EQ(std::memcmp(&found, &expected, sizeof found), 0) << "path " << path_index;
      lit += is_black(expected.radiance) ? 0 : 1;
    }
    EXPECT_GT(lit, 0);
  }

 private:
  /// What blocks do, one after the other. Beyond what a block may use of its memory nothing is
  /// written.
  template <class Traits>
  void run(int blocks, std::uint32_t at_once, int slots_per_thread, const BegunPaths& begun) {
    using Memory = BlockWavefrontMemory<BlockWavefrontLane<Traits>, threads>;
    const auto memory = std::make_unique<Memory>();
    std::uint32_t next_path = 0;
    const PathShare paths{&next_path, at_once, slots_per_thread};
    const auto* const bytes = reinterpret_cast<const unsigned char*>(memory.get());
    for (int i = 0; i < blocks; ++i) {
      std::memset(static_cast<void*>(memory.get()), 0xa5, sizeof *memory);
      EmulatedBlock(threads).run([&] {
        uint2 stack[block_wavefront_stack_size<BlockWavefrontLane<Traits>>];
        BlockWavefront<Traits, SamplerSource, Memory> tracer(
            scene_, source_, batch_, path_settings_, paths, *memory,
            begun.slots.of_block(static_cast<std::uint32_t>(i)), stack);
        tracer.run(begun.count_in(static_cast<std::uint32_t>(i)));
      });
      ASSERT_TRUE(std::all_of(bytes + Memory::bytes(slots_per_thread), bytes + sizeof *memory,
                              [](unsigned char byte) { return byte == 0xa5; }));
    }
  }

  /// The slots of blocks, which hold what is no path.
  template <class Traits>
  BlockSlots make_slots(int blocks, int slots_per_thread) {
    const auto per_block = static_cast<std::uint32_t>(threads * slots_per_thread);
    slots_.resize(std::size_t{per_block} * blocks);
    media_.assign(Traits::has_media ? slots_.size() : 0, PathRecord{-1, -1, -1, 0x12345678});
    std::memset(static_cast<void*>(slots_.data()), 0xa5, slots_.size() * sizeof(PathSlot));
    extra_.resize(slots_.size() * path_settings_.extra_records);
    return {slots_.data(), Traits::has_media ? media_.data() : nullptr, per_block,
            ExtraState::by_place(extra_.data(), path_settings_.extra_records)};
  }

  /// Puts the paths that `rays` rays do not end into slots of the pool, and returns these.
  template <class Traits>
  std::vector<std::uint32_t> begin(const PathPool& pool, int rays) {
    std::vector<std::uint32_t> left;
    for (std::uint32_t path_index = 0; path_index < batch_.path_count; ++path_index) {
      const PathId id = batch_.id_of(path_index);
      auto random = source_.open(id);
      PathState path;
      path.index = path_index;
      Ray ray = begin_path(scene_, id, random);
      Color radiance(0.0f);
      const std::uint32_t slot = batch_.path_count - 1 - path_index;
      pool.extra.begin(slot, path_index);
      bool alive = true;
      for (int i = 0; i < rays && alive; ++i) {
        alive = follow_ray<Traits>(scene_, ray, path, radiance, path_settings_, random,
                                   path_hash<Traits>(scene_, id));
        if (alive) pool.extra.step(slot);
      }
      batch_.store(path, radiance);
      if (!alive) continue;
      if (rays == 0) {
        pool.store_new_path(slot, ray, path_index);
      } else {
        pool.store_path(slot, ray, path);
      }
      if constexpr (Traits::has_media) pool.store_medium(slot, path);
      left.push_back(slot);
    }
    return left;
  }

  template <class Traits>
  Sample follow(std::uint32_t path_index) const {
    const PathId id = batch_.id_of(path_index);
    auto random = source_.open(id);
    PathState path;
    path.index = path_index;
    const Ray ray = begin_path(scene_, id, random);
    const Color radiance = follow_path<Traits>(scene_, ray, path, Color(0.0f), path_settings_,
                                               random, path_hash<Traits>(scene_, id));
    return {radiance, path.packed_rays()};
  }

  Scene scene_;
  SamplerSource source_;
  PathSettings path_settings_;
  std::vector<Sample> samples_;
  SampleBuffer batch_;
  std::vector<PathSlot> slots_;
  std::vector<PathRecord> media_;
  std::vector<ExtraRecord> extra_;
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
                    ImageKind{"path_bytes", {{"scene", "boxes"}, {"path-bytes", "80"}}},
                    ImageKind{"light_tree", {{"scene", "boxes"}, {"light-selection", "tree"}}},
                    ImageKind{"no_light_sampling", {{"scene", "boxes"}, {"nee", "off"}}},
                    ImageKind{"camera_rays", {{"scene", "boxes"}, {"max-depth", "1"}}},
                    ImageKind{"one_path", {{"scene", "boxes"}, {"width", "1"}, {"height", "1"}}}),
    [](const auto& kind) { return kind.param.name; });

TEST_P(SortingOf, GivesEachPathWhatItGetsAlone) {
  using Traits = PlainTraits;
  const Options options = with(small_image(), GetParam().settings);
  const SceneData scene = make_scene_for(options, choose_device({DeviceChoice::Kind::cpu}));
  ASSERT_EQ(scene.traits, Traits::value());
  SortedPaths paths(scene, options);
  paths.sort<Traits>(2, 100);
  paths.expect_what_each_gets_alone<Traits>();
}

TEST(SortingOfFewSlots, GivesEachPathWhatItGetsAlone) {
  using Traits = PlainTraits;
  const Options options = with(small_image(), {{"scene", "boxes"}});
  const SceneData scene = make_scene_for(options, choose_device({DeviceChoice::Kind::cpu}));
  for (const int slots_per_thread : {1, 4, 7}) {
    SortedPaths paths(scene, options);
    paths.sort<Traits>(2, 300, slots_per_thread);
    paths.expect_what_each_gets_alone<Traits>();
  }
}

TEST_P(SortingOf, FinishesWhatWavesHaveLeftOver) {
  using Traits = PlainTraits;
  const Options options = with(small_image(), GetParam().settings);
  const SceneData scene = make_scene_for(options, choose_device({DeviceChoice::Kind::cpu}));
  for (const int rays : {0, 1, 3}) {
    if (rays >= options.max_depth) continue;
    SortedPaths paths(scene, options);
    paths.finish<Traits>(rays, 3, 4);
    paths.expect_what_each_gets_alone<Traits>();
  }
}

TEST(SortingOfMasks, FinishesWhatWavesHaveLeftOver) {
  const Options options = with(small_image(), {{"width", "31"}, {"height", "23"}});
  SceneData scene = masked_room();
  prepare_scene(scene, options);
  SortedPaths paths(scene, options);
  paths.finish<MaskedTraits>(2, 2, 12);
  paths.expect_what_each_gets_alone<MaskedTraits>();
}

TEST(SortingOfMedia, GivesEachPathWhatItGetsAlone) {
  using Traits = MediaTraits;
  const Options options = with(
      small_image(),
      {{"width", "31"}, {"height", "23"}, {"max-depth", "12"}, {"rr", "4"}, {"path-bytes", "32"}});
  SceneData scene = filled_glasses();
  prepare_scene(scene, options);
  ASSERT_TRUE(scene.traits.has_media);
  ASSERT_FALSE(scene.properties.has_open_boundaries);
  SortedPaths paths(scene, options);
  paths.sort<Traits>(2, 1000);
  paths.expect_what_each_gets_alone<Traits>();
  for (const int rays : {0, 1, 2, 6}) {
    SortedPaths rest(scene, options);
    rest.finish<Traits>(rays, 3, 12);
    rest.expect_what_each_gets_alone<Traits>();
  }
}

/// Trees in a wood: turned, stretched and sheared, of several groups, in front of each other.
Options wood(const Settings& more = {}) {
  const Options options = with(small_image(), {{"scene", "instances:300"}, {"max-depth", "8"}});
  return with(options, more);
}

TEST(SortingOfInstances, GivesEachPathWhatItGetsAlone) {
  using Traits = InstancedTraits;
  for (const Settings& settings :
       {Settings{}, Settings{{"rr", "2"}, {"max-depth", "20"}}, Settings{{"nee", "off"}}}) {
    const Options options = wood(settings);
    const SceneData scene = make_scene_for(options, choose_device({DeviceChoice::Kind::cpu}));
    ASSERT_EQ(scene.traits.geometry, Geometry::mixed);
    SortedPaths paths(scene, options);
    paths.sort<Traits>(2, 100);
    paths.expect_what_each_gets_alone<Traits>();
  }
}

TEST(SortingOfInstances, FinishesWhatWavesHaveLeftOver) {
  const Options options = wood({{"width", "37"}, {"height", "21"}});
  const SceneData scene = make_scene_for(options, choose_device({DeviceChoice::Kind::cpu}));
  for (const int rays : {0, 1, 3}) {
    for (const int slots_per_thread : {12, 5}) {
      SortedPaths paths(scene, options);
      paths.finish<InstancedTraits>(rays, 5, slots_per_thread);
      paths.expect_what_each_gets_alone<InstancedTraits>();
    }
  }
}

TEST(BegunPaths, EachHasAPlaceOfItsOwnInTheFirstSlotsOfABlock) {
  constexpr std::uint32_t blocks = 7, per_block = 10;
  std::vector<PathSlot> slots(blocks * per_block);
  for (std::uint32_t count = 1; count <= blocks * per_block; ++count) {
    const BegunPaths paths = BegunPaths::divide({slots.data(), nullptr, per_block}, count, blocks);
    std::vector<int> used(slots.size());
    for (std::uint32_t k = 0; k < count; ++k) ++used.at(paths.place(k));
    for (std::uint32_t slot = 0; slot < slots.size(); ++slot) {
      const bool is_used = slot % per_block < paths.count_in(slot / per_block);
      ASSERT_EQ(used[slot], is_used ? 1 : 0) << slot << " of " << count;
    }
  }
}

TEST(SortingOfMasks, GivesEachPathWhatItGetsAlone) {
  const Options options = with(small_image(), {{"width", "31"}, {"height", "23"}});
  SceneData scene = masked_room();
  prepare_scene(scene, options);
  ASSERT_TRUE(scene.traits.has_masks);
  SortedPaths paths(scene, options);
  paths.sort<MaskedTraits>(1, 31 * 23 * 2);
  paths.expect_what_each_gets_alone<MaskedTraits>();
}

TEST(SortingOfMasks, EndsCameraRaysAtTheFarPlane) {
  const Options options = with(small_image(), {{"width", "31"}, {"height", "23"}});
  SceneData scene = limited_room();
  prepare_scene(scene, options);
  ASSERT_TRUE(is_limited(scene.camera));
  SortedPaths paths(scene, options);
  paths.sort<MaskedTraits>(1, 31 * 23 * 2);
  paths.expect_what_each_gets_alone<MaskedTraits>();
}

}  // namespace
}  // namespace pt
