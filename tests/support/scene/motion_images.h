// What tests of images of motion have in common: renders on the CPU, and what they are compared by.
#pragma once

#include <functional>

#include "scene/moving_room.h"
#include "statistics.h"

namespace pt {

inline Image image_of_motion(SceneData scene, Options options, const std::string& accel = "bvh2") {
  options.accel = accel == "bvh2"    ? AccelKind::bvh2
                  : accel == "cwbvh" ? AccelKind::cwbvh
                                     : AccelKind::brute;
  if (options.mode == Mode::automatic) options.mode = Mode::megakernel;
  prepare_scene_for(scene, options, cpu_of_motion());
  const auto renderer = make_renderer(options, scene, cpu_of_motion());
  renderer->render({});
  return renderer->image();
}

/// 16 x 1 pixels, each of size 1 in the plane z = 0, and a shining square of x in [2, 5].
inline SceneData band_scene() {
  SceneData scene;
  scene.name = "band";
  scene.camera.look_from = {8, 0, 10}, scene.camera.look_at = {8, 0, 0};
  scene.camera.orthographic = true, scene.camera.orthographic_size = {8, 8};
  scene.add_material(make_diffuse(Color(0.0f), Color(1.0f)));
  scene.meshes = {square_of(2, 5, -9, 9, 0, 0, 1)};
  scene.instances = {{1, {}}};
  return scene;
}

/// Time for which a pixel of the band sees what lies in x from `left` to `right` and goes `way`
/// pixels to the right.
inline double seen_part(int pixel, double way, double left = 2, double right = 5) {
  const auto area = [&](double x, double edge) {  // under the time for which the edge is left of x
    const double d = std::clamp(x - edge, 0.0, way);
    return d * d / (2 * way) + std::max(0.0, x - edge - way);
  };
  const auto mean = [&](double edge) { return area(pixel + 1, edge) - area(pixel, edge); };
  return mean(left) - mean(right);
}

inline void expect_band(const Image& image, const std::function<double(int)>& expected) {
  for (int x = 0; x < 16; ++x) EXPECT_NEAR(image.pixel(x, 0)[0], expected(x), 0.012) << x;
}

/// By the tree and by brute force, with the band in an instance and in the world.
inline void expect_band_everywhere(SceneData scene, const Options& options,
                                   const std::function<double(int)>& expected) {
  expect_band(image_of_motion(scene, options), expected);
  expect_band(image_of_motion(scene, options, "brute"), expected);
  scene.instances.clear(), scene.meshes[0].group = 0;
  expect_band(image_of_motion(scene, options), expected);
}

/// Means over columns of 8 pixels of the image's halves, by renders of different seeds.
inline std::vector<MeanEstimate> region_means(const std::function<Image(std::uint64_t)>& render,
                                              int count) {
  std::vector<MeanEstimate> means(8);
  for (int seed = 0; seed < count; ++seed) {
    const Image image = render(static_cast<std::uint64_t>(seed + 1));
    std::vector<double> sums(8);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        sums[static_cast<std::size_t>(4 * (2 * y / image.height) + 4 * x / image.width)] +=
            double{image.pixel(x, y)[0]};
    for (std::size_t i = 0; i < sums.size(); ++i) means[i].add(sums[i]);
  }
  return means;
}

inline void expect_same_means(const std::vector<MeanEstimate>& a,
                              const std::vector<MeanEstimate>& b, const char* what) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double sigma = std::hypot(a[i].sigma(), b[i].sigma());
    EXPECT_LT(std::abs(a[i].mean() - b[i].mean()), 5 * sigma) << what << ", region " << i;
    EXPECT_LT(sigma, 0.05 * a[i].mean()) << what << ", region " << i;
  }
}

inline std::vector<MeanEstimate> means_of(const SceneData& scene, const Options& options) {
  const auto render = [&](std::uint64_t seed) {
    Options own = options;
    own.seed = seed;
    return image_of_motion(scene, own);
  };
  return region_means(render, 20);
}

/// That a moving scene's image is the mean of images of what `at` gives for times in [0, 1), at
/// rest: as many, at stratified times, as the moving one has samples. Returns the moving one's
/// means.
inline std::vector<MeanEstimate> expect_mean_of_still(const SceneData& moving,
                                                      const Options& options,
                                                      const std::function<SceneData(float)>& at) {
  const auto render_still = [&](std::uint64_t seed) {
    const auto count = static_cast<float>(options.spp);
    TestRandom random(seed);
    Image sum;
    for (int i = 0; i < options.spp; ++i) {
      Options own = options;
      own.seed = 1000 * seed + static_cast<std::uint64_t>(i), own.spp = 1;
      const Image one = image_of_motion(at((static_cast<float>(i) + random.unit()) / count), own);
      if (sum.rgb.empty()) sum = {one.width, one.height, std::vector<float>(one.rgb.size())};
      for (std::size_t k = 0; k < one.rgb.size(); ++k) sum.rgb[k] += one.rgb[k] / count;
    }
    return sum;
  };
  std::vector<MeanEstimate> means = means_of(moving, options);
  expect_same_means(means, region_means(render_still, 20), "static renders");
  return means;
}

/// What moves, held at a time.
inline std::function<SceneData(float)> held(const SceneData& moving) {
  return [moving](float time) {
    SceneData scene = moving;
    hold_still_at(scene, time);
    return scene;
  };
}

}  // namespace pt
