// Scenes with media give the same bits in all modes, whatever the options that say how.
#include <gtest/gtest.h>

#include "cloud_modes.h"
#include "medium/filled_glasses.h"

namespace pt {
namespace {

/// Small, odd, and no multiple of a block.
Options fog_options(const std::string& mode, const Settings& more = {}) {
  return with(with(Options(), {{"device", "cpu"},
                               {"scene", "fog"},
                               {"mode", mode},
                               {"width", "45"},
                               {"height", "29"},
                               {"spp", "5"},
                               {"max-depth", "12"},
                               {"rr", "4"}}),
              more);
}

const Choice threads{"threads", {"2", "1", "3", "7"}};
const std::vector<Choice> megakernel_choices{threads, {"work", names_of(Work::persistent)}};

std::vector<Choice> wavefront_choices(const std::vector<std::string>& pools) {
  return {threads,
          {"compaction", names_of(Compaction::atomic)},
          {"pool-size", pools},
          {"regenerate", {"on", "off"}},
          {"finish-paths", {"0", "1", "700", "131072"}},
          {"layout", names_of(PoolLayout::soa)},
          {"stages", names_of(Stages::split, {Stages::automatic})},
          {"wave-collisions", {"0", "1", "2", "7", "1000"}},
          {"order-surfaces", {"auto", "on", "off"}}};
}

/// For the scenes of cloud_options, which have 1,380 paths.
const std::vector<std::string> cloud_pools{"auto", "300", "11", "1380", "1381"};

TEST(FogModes, MegakernelEqualsSerial) {
  expect_all_same(fog_options("megakernel"), variations(megakernel_choices, 5, 1),
                  fog_options("serial"));
}

TEST(FogModes, WavefrontEqualsSerial) {
  const Options options = fog_options("wavefront");
  const std::vector<Choice> choices = wavefront_choices({"auto", "1000", "7", "6525", "6526"});
  expect_all_same(options, planned(options, variations(choices, 12, 2)), fog_options("serial"));
}

TEST(FogModes, StructuresAndSamplersKeepThem) {
  for (const Settings& more : {Settings{{"accel", "brute"}}, Settings{{"accel", "cwbvh"}},
                               Settings{{"sampler", "sobol"}}, Settings{{"mis", "balance"}},
                               Settings{{"nee", "off"}}, Settings{{"sampling", "uniform"}}}) {
    SCOPED_TRACE(more.front().second);
    const Rendered serial = render_options(fog_options("serial", more));
    expect_same(render_options(fog_options("megakernel", more)), serial);
    expect_same(render_options(fog_options("wavefront", more)), serial);
  }
}

void expect_same_media(const SceneData& scene, const std::string& mode,
                       const std::vector<Choice>& choices, std::uint64_t seed) {
  Options reference = cloud_options("serial");
  std::vector<Rendered> expected;  // of two seeds, which take turns: see expect_all_same
  int i = 0;
  for (const Settings& settings : variations(choices, 12, seed)) {
    Options options = cloud_options(mode, settings);
    if (!has_plan(options, scene)) continue;
    if (expected.size() < 2) {
      expected.push_back(render_clouds(scene, reference));
      expect_plausible(expected.back(), reference);
      ++reference.seed;
    }
    options.seed += static_cast<std::uint64_t>(i % 2);
    SCOPED_TRACE(command_of(options));
    expect_same(render_clouds(scene, options), expected[static_cast<std::size_t>(i % 2)]);
    if (testing::Test::HasFailure()) return;
    ++i;
  }
  EXPECT_GT(i, 8);
}

TEST(CloudModes, MegakernelEqualsSerial) {
  expect_same_media(clouds(), "megakernel", megakernel_choices, 3);
}

TEST(CloudModes, WavefrontEqualsSerial) {
  expect_same_media(clouds(), "wavefront", wavefront_choices(cloud_pools), 4);
}

TEST(OverlappingModes, EqualSerial) {
  expect_same_media(overlapping_clouds(), "megakernel", megakernel_choices, 7);
  expect_same_media(overlapping_clouds(), "wavefront", wavefront_choices(cloud_pools), 8);
}

// All boundaries have a BSDF, and still light goes through those that are hidden: water that
// reaches into a ball of glass.
TEST(OverlappingModes, EqualSerialWithoutOpenBoundaries) {
  SceneData scene = filled_glasses();
  scene.media[0].priority = 2, scene.media[1].priority = 1;
  add_cuboid(scene, {-1, -0.6f, -0.3f}, {0.2f, 0.2f, 0.4f}, material_around(scene, 1));
  expect_same_media(scene, "megakernel", megakernel_choices, 9);
  expect_same_media(scene, "wavefront", wavefront_choices(cloud_pools), 10);
}

// Their rays are traced in blocks.
TEST(GlassModes, WavefrontEqualsSerial) {
  for (const bool has_masks : {false, true}) {
    const SceneData scene = filled_glasses(has_masks);
    expect_same_media(scene, "wavefront", wavefront_choices(cloud_pools), 5 + has_masks);
    for (const char* accel : {"auto", "bvh2", "cwbvh"}) {
      const Options options = cloud_options("wavefront", {{"accel", accel}, {"spp", "20"}});
      SCOPED_TRACE(accel);
      expect_same(render_clouds(scene, options),
                  render_clouds(scene, cloud_options("serial", {{"spp", "20"}})));
    }
  }
}

// With the other options as usual, and in a pool of some slots, where paths of all kinds meet.
TEST(CloudModes, FlightsMayPauseAtAnyCollision) {
  const SceneData scene = clouds();
  for (const Settings& more : {Settings{}, Settings{{"nee", "off"}}, Settings{{"sampler", "sobol"}},
                               Settings{{"accel", "brute"}}, Settings{{"accel", "cwbvh"}}}) {
    const Rendered serial = render_clouds(scene, cloud_options("serial", more));
    for (const std::string collisions : {"1", "2", "7", "1000", "65535"}) {
      for (const std::string pool : {"auto", "50"}) {
        Settings settings{{"wave-collisions", collisions}, {"pool-size", pool}};
        settings.insert(settings.end(), more.begin(), more.end());
        const Options options = cloud_options("wavefront", settings);
        SCOPED_TRACE(command_of(options));
        expect_same(render_clouds(scene, options), serial);
      }
    }
  }
}

TEST(MediaRefusals, ChainsHaveNoFlights) {
  for (const char* mode : {"serial", "megakernel", "wavefront"}) {
    EXPECT_EQ(refusal_of({{"device", "cpu"},
                          {"mode", mode},
                          {"scene", "fog"},
                          {"integrator", "mlt"},
                          {"width", "8"},
                          {"height", "8"}}),
              "a scene with media with --integrator mlt: where a flight ends is no random number "
              "that a chain could keep; expected path");
  }
}

TEST(MediaRefusals, WavesWithoutMediaCountNoCollisions) {
  EXPECT_EQ(refusal_of({{"device", "cpu"},
                        {"mode", "wavefront"},
                        {"scene", "cornell"},
                        {"wave-collisions", "5"}}),
            "--wave-collisions 5: counts what free flights in media meet; scene 'cornell' has no "
            "media, expected 0");
}

}  // namespace
}  // namespace pt
