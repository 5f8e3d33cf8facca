// Images with light sampling against a second path tracer that finds its lights by chance.
#include <gtest/gtest.h>

#include <thread>

#include "common/scene/builtin/builtin_scenes.h"
#include "reference_tracer.h"
#include "render_serial.h"

namespace pt {
namespace {

constexpr std::size_t block_count = 16;    ///< 4 x 4 blocks of an image of 16 x 16 pixels
using Blocks = std::vector<MeanEstimate>;  ///< [block][channel]

void add(Blocks& blocks, std::size_t block, const glm::dvec3& radiance) {
  for (int c = 0; c < 3; ++c) blocks[3 * block + static_cast<std::size_t>(c)].add(radiance[c]);
}

Blocks reference_blocks(const SceneData& scene, int max_depth, int paths_per_block) {
  const ReferenceTracer tracer(scene, max_depth);
  Blocks blocks(3 * block_count);
  const auto work = [&](std::size_t first) {
    for (std::size_t block = first; block < block_count; block += 2) {
      TestRandom random(block + 1);
      for (int i = 0; i < paths_per_block; ++i) {
        const double x = (static_cast<double>(block % 4) + random.uniform(0, 1)) / 2 - 1;
        const double y = 1 - (static_cast<double>(block / 4) + random.uniform(0, 1)) / 2;
        add(blocks, block, tracer.sample(1, x, y, random));
      }
    }
  };
  std::thread other(work, 1);
  work(0);
  other.join();
  return blocks;
}

/// Every seed is one sample of each block's mean.
Blocks rendered_blocks(const SceneData& scene, int max_depth) {
  Options options = image_options(16, 16, 32, max_depth);
  Blocks blocks(3 * block_count);
  for (options.seed = 1; options.seed <= 32; ++options.seed) {
    const Image image = render(scene, options).image;
    for (std::size_t block = 0; block < block_count; ++block) {
      glm::dvec3 mean(0);
      for (int i = 0; i < 16; ++i) {
        const float* p = image.pixel(static_cast<int>(block % 4) * 4 + i % 4,
                                     static_cast<int>(block / 4) * 4 + i / 4);
        mean += glm::dvec3(p[0], p[1], p[2]) / 16.0;
      }
      add(blocks, block, mean);
    }
  }
  return blocks;
}

/// `precision`: the standard deviation that the comparison of the whole images needs at least.
void expect_equals_reference(const SceneData& scene, int max_depth, int paths_per_block,
                             double precision) {
  const Blocks expected = reference_blocks(scene, max_depth, paths_per_block);
  const Blocks found = rendered_blocks(scene, max_depth);
  double total = 0, total_expected = 0, variance = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const double sigma = std::hypot(expected[i].sigma(), found[i].sigma());
    EXPECT_NEAR(found[i].mean(), expected[i].mean(), 5 * sigma + 1e-6)
        << "block " << i / 3 << ", channel " << i % 3;
    total += found[i].mean(), total_expected += expected[i].mean(), variance += sigma * sigma;
  }
  const double sigma = std::sqrt(3 * variance);  // the channels of a block deviate together
  EXPECT_NEAR(total, total_expected, 5 * sigma);
  EXPECT_LT(sigma, precision * total_expected) << "too noisy to tell";
}

TEST(LightSampling, CornellEqualsPathsThatFindTheLampByChance) {
  Options options;
  options.scene = "cornell";
  expect_equals_reference(make_scene(options), 8, 150'000, 0.012);
}

// Both shapes of lights, under a sky, seen by glossy and by diffuse surfaces.
TEST(LightSampling, TwoLightsMetalAndASky) {
  SceneData scene;
  const auto floor = scene.add_material(make_metal({0.25f, 0.5f, 1}, 0.8f));
  const auto lamp = scene.add_material(make_diffuse({0.5f, 0.3f, 0.1f}, {2, 3, 1}));
  const auto smooth = scene.add_material(make_metal({0.9f, 0.8f, 0.7f}, 0.3f));
  const auto diffuse = scene.add_material(make_diffuse({0.7f, 0.8f, 0.9f}));
  scene.add_quad({-9, 0, -9}, {0, 0, 18}, {18, 0, 0}, floor);
  scene.add_quad({0.5f, 2.5f, -1}, {1.5f, 0.5f, 0}, {0, 0, 2}, lamp);  // faces down
  scene.add_sphere({-1.5f, 1.2f, 0}, 0.7f, lamp);
  scene.add_sphere({0.8f, 0.7f, 0.3f}, 0.7f, smooth);
  scene.add_sphere({0, 0.4f, 1.5f}, 0.4f, diffuse);
  scene.sky = {Color(0.1f), {0.2f, 0.3f, 0.5f}};
  scene.camera = {{1, 2, 6}, {0, 0.8f, 0}, {0, 1, 0}, 45, 0, 6};
  prepare_scene(scene);
  expect_equals_reference(scene, 6, 400'000, 0.002);
}

}  // namespace
}  // namespace pt
