// What must hold of sums over paths: Russian roulette keeps the mean, a sample that is not finite
// is left out of it, and batches add up to what was asked for.
#include <limits>

#include "common/film/develop.h"
#include "common/render/batches.h"
#include "common/scene/builtin/builtin_scenes.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/transport/generate_camera_path.h"
#include "common/transport/path.h"
#include "render_serial.h"
#include "statistics.h"

namespace pt {
namespace {

TEST(Roulette, KeepsTheMeanOfEachChannel) {
  constexpr int steps = 1 << 20;
  for (const Color beta : {Color(0.5f, 0.2f, 0), Color(0, 0.3f, 0.1f), Color(0.9f, 0.9f, 0.2f),
                           Color(0, 0, 0.04f), Color(1, 0.99f, 0.5f), Color(3, 2, 0.25f)}) {
    glm::dvec3 sum(0);
    int alive = 0;
    for (int i = 0; i < steps; ++i) {
      Color played = beta;
      play_roulette(played, (static_cast<float>(i) + 0.5f) / steps);
      sum += glm::dvec3(played);
      alive += !is_black(played);
    }
    const double largest = std::max({beta.x, beta.y, beta.z});
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c] / steps, beta[c], 1e-5 * largest) << c;
    // By the largest channel, but some always end.
    EXPECT_NEAR(static_cast<double>(alive) / steps, std::min(largest, 0.95), 1e-5);
  }
}

TEST(Roulette, BeginsWithTheRayThatIsAskedFor) {
  PathSettings settings;
  for (const std::uint32_t rays : {0u, 1u, 2u, 1000u}) {
    EXPECT_FALSE(settings.is_roulette(rays)) << "never, unless asked for";
  }
  settings.roulette_depth = 3;
  EXPECT_FALSE(settings.is_roulette(2));
  EXPECT_TRUE(settings.is_roulette(3));
  EXPECT_TRUE(settings.is_roulette(4));
}

// In a closed room of albedo 1/2 a path that plays always survives by 1/2: each ray from the first
// that plays on is followed by one other on average.
TEST(Roulette, EndsPathsAsOftenAsItSays) {
  SceneData scene;
  scene.add_sphere({0, 0, 0}, 3, scene.add_material(make_diffuse(Color(0.5f, 0.25f, 0))));
  scene.sky = {Color(1.0f), Color(1.0f)};
  scene.camera = {{0.5f, 0, 0}, {0, 0, 1}, {0, 1, 0}, 60, 0, 1};
  prepare_scene(scene);
  for (const int depth : {1, 2, 4}) {
    Options options = image_options(64, 64, 16, 200);
    options.rr_depth = depth;
    const PathCounts counts = render(scene, options).counts;
    // beta is 2^-depth when it plays first and 1 after having survived, so 2^-depth, then 1/2.
    const double expected = depth + std::pow(0.5, depth) * 2;
    const double mean = static_cast<double>(counts.rays) / static_cast<double>(counts.paths);
    // A geometric distribution: its variance is below 3 here.
    EXPECT_NEAR(mean, expected, 5 * std::sqrt(3.0 / static_cast<double>(counts.paths)));
    for (int k = 0; k < depth; ++k) {
      EXPECT_EQ(counts.live_paths[static_cast<std::size_t>(k)], counts.paths)
          << "ray " << k << " of " << depth;
    }
    EXPECT_LT(counts.live_paths[static_cast<std::size_t>(depth)], counts.paths);
  }
}

/// One pixel among four, with samples of which some are not finite.
TEST(Film, WhatIsNotFiniteIsCountedAndLeftOut) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr float inf = std::numeric_limits<float>::infinity();
  const Color values[] = {{1, 2, 3}, {nan, 0, 0}, {3, 2, 1}, {0, inf, 0}, {0, 0, -inf},
                          {2, 2, 2}, {0, nan, 0}, {1, 1, 1}, {5, 4, 3},   {0, 0, nan}};
  constexpr std::uint32_t count = 10, pixels = 4, pixel = 2;
  std::vector<Sample> samples(count * pixels, Sample{Color(7.0f), 1});
  for (std::uint32_t i = 0; i < count; ++i) samples[i * pixels + pixel] = {values[i], 2 | 1 << 16};
  SampleBuffer buffer;
  buffer.samples = samples.data();
  buffer.width = FastDivider(2), buffer.pixel_count = FastDivider(pixels);
  buffer.sample_count = count, buffer.path_count = count * pixels;
  std::vector<FilmPixel> film(pixels);
  PathTally tally;
  for (int batch = 1; batch <= 2; ++batch) {
    int lengths = 0;
    accumulate_pixel(RadianceSum(film.data(), pixel), buffer, pixel, tally,
                     [&](int bin) { lengths += bin == 1; });
    EXPECT_EQ(lengths, 10);
    EXPECT_EQ(film[pixel].samples, 5u * static_cast<unsigned>(batch));
    EXPECT_EQ(tally.nonfinite, 5u * static_cast<unsigned>(batch));
    EXPECT_EQ(tally.rays, 20u * static_cast<unsigned>(batch));
    EXPECT_EQ(tally.shadow_rays, 10u * static_cast<unsigned>(batch));
    const Image image = develop(film, 2, 2);
    EXPECT_FLOAT_EQ(image.rgb[3 * pixel], 12.0f / 5);
    EXPECT_FLOAT_EQ(image.rgb[3 * pixel + 1], 11.0f / 5);
    EXPECT_FLOAT_EQ(image.rgb[3 * pixel + 2], 10.0f / 5);
    EXPECT_EQ(image.rgb[0], 0.0f) << "a pixel without samples is black";
  }
}

using BatchList = std::vector<std::pair<int, int>>;

BatchList batches_of(int spp, int per_batch, std::uint64_t pixels = 10) {
  BatchList batches;
  std::vector<std::uint64_t> progress;
  const RenderHooks hooks = {[&](std::uint64_t done, std::uint64_t total) {
                               EXPECT_EQ(total, pixels * static_cast<std::uint64_t>(spp));
                               progress.push_back(done);
                             },
                             {}};
  const BatchRun run = for_each_batch(spp, per_batch, pixels, hooks, [&](int first, int n) {
    batches.emplace_back(first, n);
    return true;
  });
  EXPECT_EQ(run.samples, spp);
  EXPECT_EQ(run.ended_by, RunEnd::samples);
  EXPECT_EQ(progress.size(), batches.size());
  EXPECT_EQ(progress.back(), pixels * static_cast<std::uint64_t>(spp));
  return batches;
}

TEST(BatchSizes, TheLastMayBeShorter) {
  EXPECT_EQ(batches_of(10, 4), (BatchList{{0, 4}, {4, 4}, {8, 2}}));
  EXPECT_EQ(batches_of(9, 3), (BatchList{{0, 3}, {3, 3}, {6, 3}}));
  EXPECT_EQ(batches_of(3, 5), (BatchList{{0, 3}}));
  EXPECT_EQ(batches_of(1, 1), (BatchList{{0, 1}}));
}

TEST(BatchSizes, AreOfEqualSizeAndFitTheBuffer) {
  EXPECT_EQ(batch_samples(10, 100, 400), 4);  // 4 + 4 + 2
  EXPECT_EQ(batch_samples(9, 100, 400), 3);
  EXPECT_EQ(batch_samples(8, 100, 800), 8);
  EXPECT_EQ(batch_samples(8, 100, 799), 4);
  EXPECT_EQ(batch_samples(5, 1000, 100), 1) << "at least one";
  for (int spp = 1; spp < 60; ++spp) {
    for (const std::uint64_t paths : {7u, 10u, 33u, 64u, 1000u}) {
      const int samples = batch_samples(spp, 3, paths);
      EXPECT_LE(static_cast<std::uint64_t>(samples) * 3, paths);
      int sum = 0;
      for (const auto& [first, n] : batches_of(spp, samples)) {
        EXPECT_EQ(first, sum);
        sum += n;
      }
      EXPECT_EQ(sum, spp);
    }
  }
}

TEST(CameraPath, TakesBothNumbersOfItsPixel) {
  Scene scene;
  scene.camera = make_camera({}, 40, 30);
  for (const Vec4& u : {Vec4(0.3f, 0.1f, 0, 0), Vec4(0.3f, 0.9f, 0, 0), Vec4(0.8f, 0.1f, 0, 0)}) {
    const Ray ray = generate_camera_path(scene, pack_pixel(7, 11), u);
    const Ray expected = camera_ray(scene.camera, 7 + u.x, 11 + u.y, 0, 0);
    EXPECT_EQ(ray.direction, expected.direction);
  }
}

TEST(LightSampling, CanBeTurnedOff) {
  for (const char* name : {"cornell", "boxes"}) {
    Options options = image_options(16, 12, 2, 4);
    options.scene = name;
    const SceneData scene = make_scene(options);
    EXPECT_GT(render(scene, options).counts.shadow_rays, 0u) << name;
    options.nee = false;
    EXPECT_EQ(render(scene, options).counts.shadow_rays, 0u) << name;
  }
}

}  // namespace
}  // namespace pt
