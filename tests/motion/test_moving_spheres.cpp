// Spheres that move, against integrals over time in closed form and against renders of scenes that
// stand still.
#include <gtest/gtest.h>

#include "common/error/error.h"
#include "common/film/aov.h"
#include "common/scene/prepare/prepare_steps.h"
#include "medium/medium_scenes.h"
#include "scene/motion_images.h"

namespace pt {
namespace {

/// The band with a shining ball instead, of radius 1.5 around `own` in the space of the keys.
SceneData ball_scene(const Affine& begin, const Affine& end, const Vec3& own = Vec3(0.0f)) {
  SceneData scene = band_scene();
  scene.meshes.clear(), scene.instances.clear();
  scene.add_sphere(begin.point(own), 1.5f, 0);
  scene.motion.spheres = {{0, {{0.0f, begin}, {1.0f, end}}}};
  return scene;
}

/// Half of the ball's chord, by the distance of a ray from its middle.
double half_chord(double y) { return std::sqrt(1.5 * 1.5 - y * y); }

/// The mean of function(y) over a pixel's height.
template <class Function>
double mean_over_height(Function&& function) {
  double sum = 0;
  for (int i = 0; i < 100; ++i) sum += function((i + 0.5) / 100 - 0.5);
  return sum / 100;
}

TEST(MovingSpheres, AreTheirIntegralsOverTime) {
  const SceneData scene = ball_scene(translate({3.5f, 0, 1}), translate({9.5f, 0, -1}));
  const auto expected = [](int x) {
    return mean_over_height(
        [x](double y) { return seen_part(x, 6, 3.5 - half_chord(y), 3.5 + half_chord(y)); });
  };
  Options options = motion_options(16, 1, 16384);
  for (const SamplerKind sampler :
       {SamplerKind::independent, SamplerKind::stratified, SamplerKind::sobol}) {
    options.sampler = sampler;
    expect_band(image_of_motion(scene, options), expected);
  }
  SceneData late = scene;  // half of the way, from its quarter on
  late.motion.shutter = {0.25f, 0.75f};
  expect_band(image_of_motion(late, options), [](int x) {
    return mean_over_height(
        [x](double y) { return seen_part(x, 3, 5 - half_chord(y), 5 + half_chord(y)); });
  });
}

TEST(MovingSpheres, GoAroundWhatTheyTurnAbout) {
  const Affine center = translate({8, 0, 0});
  const SceneData scene = ball_scene(center, center * rotate({0, 1, 0}, 120),
                                     {5, 0, 0});  // of which the view is along z
  expect_band(image_of_motion(scene, motion_options(16, 1, 16384)), [](int x) {
    return mean_over_height([x](double y) {
      double sum = 0;
      for (int i = 0; i < 1000; ++i) {
        const double middle = 8 + 5 * std::cos((i + 0.5) / 1000 * 2 * pi_double / 3);
        const double c = half_chord(y);
        sum += std::max(0.0, std::min(x + 1.0, middle + c) - std::max(double(x), middle - c));
      }
      return sum / 1000;
    });
  });
}

TEST(MovingSpheres, AreWithinTheirBoxes) {
  SceneData scene = ball_scene(Affine(), rotate({0, 1, 0}, 120), {5, 0, 0});
  prepare_motion(scene);
  const Bounds box = moving_sphere_bounds(scene, 0);
  EXPECT_LE(box.min.z, -6.5f);  // at 90 degrees
  EXPECT_NEAR(box.min.z, -6.5f, 0.01f);
  EXPECT_NEAR(box.max.z, 1.5f, 0.01f);
  EXPECT_NEAR(box.min.x, -4.0f, 0.01f);
  EXPECT_NEAR(box.max.x, 6.5f, 0.01f);
}

TEST(MovingSpheres, TurnTheirPictures) {
  SceneData scene = ball_scene(translate({8, 0, 0}), translate({8, 0, 0}) * rotate({0, 0, 1}, 90));
  Texture look;
  look.filter = TextureFilter::nearest;
  MaterialDescription halves = make_diffuse(Color(1.0f));  // white where the angle is up to 180
  halves.parameters[0].texture = add_picture(scene, 2, 1, {Color(1.0f), Color(0.0f)}, look);
  scene.sphere_material[0] = scene.add_material(halves);
  scene.sphere_frames = {SphereFrame()};
  scene.spheres[0].radius_squared = 49;
  scene.sky.nadir = scene.sky.zenith = Color(1.0f);
  const Image image = image_of_motion(scene, motion_options(16, 1, 16384, 2));
  for (int x = 2; x < 14; ++x) {
    if (x > 4 && x < 11) continue;
    // Its own angle is the ray's, less 0 to 90 degrees: what lies right is white for as long as
    // that is above 0; what lies left, from the time on when it is below 180.
    const double white = mean_over_height([x](double y) {
      const double angle = 2 * std::atan2(y, x + 0.5 - 8) / pi_double;  // 1: 90 degrees
      if (x > 8) return std::clamp(angle, 0.0, 1.0);
      return 1 - (angle < 0 ? 2 + angle : 0.0);
    });
    EXPECT_NEAR(image.pixel(x, 0)[0], white, 0.012) << x;
  }
}

/// A white floor, of which the camera sees the origin, and a lamp that passes over it.
TEST(MovingSpheres, LightWhatTheyPass) {
  SceneData scene;
  scene.name = "passing lamp";
  scene.camera = {{0, 3, -6}, {0, 0, 0}, {0, 1, 0}, 0.05f, 0.0f, 6.0f};
  Mesh floor = square_of(-9, 9, -9, 9, 0, scene.add_material(make_diffuse(Color(1.0f))));
  for (Vec3& p : floor.positions) p = {p.x, 0, -p.y};
  scene.meshes = {floor};
  scene.add_sphere({-2, 2, 0}, 0.5f, scene.add_material(make_diffuse(Color(0.0f), Color(20.0f))));
  scene.motion.spheres = {
      {0, {{0.0f, translate({-2, 2, 0})}, {1.0f, translate({2, 2, 0}) * rotate({1, 0, 0}, 50)}}}};
  // The mean of L r^2 h / d^3 for d^2 = x^2 + h^2, x from -2 to 2.
  const double expected = 20 * 0.25 / (4 * 2) * 4 / std::sqrt(8.0);
  Options options = motion_options(8, 8, 1024, 2);
  const auto mean = [&] {
    double sum = 0;
    const Image image = image_of_motion(scene, options);
    for (const float value : image.rgb) sum += double{value};
    return sum / static_cast<double>(image.rgb.size());
  };
  EXPECT_NEAR(mean(), expected, 0.01 * expected);
  options.mis = MisHeuristic::balance, options.light_selection = LightSelection::uniform;
  EXPECT_NEAR(mean(), expected, 0.01 * expected);
  options.nee = false, options.spp = 16384;
  EXPECT_NEAR(mean(), expected, 0.02 * expected);
}

TEST(MovingSpheres, HaveTheirWayInTheMotionLayer) {
  const SceneData scene = ball_scene(translate({3.5f, 0, 1}), translate({9.5f, 0, -1}));
  Options options = motion_options(16, 1, 4096);
  options.aovs = aov_bit<aov::Motion>;
  const Image image = image_of_motion(scene, options);
  for (int x = 0; x < 16; ++x) {
    const double part = mean_over_height(
        [x](double y) { return seen_part(x, 6, 3.5 - half_chord(y), 3.5 + half_chord(y)); });
    EXPECT_NEAR(image.layers[0].values[static_cast<std::size_t>(2 * x)], 6 * part, 0.15) << x;
  }
}

TEST(MovingSpheres, AreTheSameInAllModesAndStructures) {
  SceneData foggy = moving_spheres();
  foggy.media = {make_medium({0.2f, 0.1f, 0.3f}, Color(0.8f))};
  foggy.camera_medium = 0, foggy.camera.hides_emitters = true;
  for (const SceneData& scene : {moving_spheres(), foggy}) {
    Options options = motion_options(40, 30, 4, 5);
    options.mode = Mode::serial;
    const std::vector<float> serial = image_of_motion(scene, options).rgb;
    for (const char* accel : {"bvh2", "brute", "cwbvh"}) {
      options.mode = Mode::megakernel;
      EXPECT_EQ(image_of_motion(scene, options, accel).rgb, serial) << accel;
      options.mode = Mode::wavefront, options.finish_paths = 0, options.pool_size = 333;
      for (const Stages stages : {Stages::split, Stages::fused}) {
        options.stages = stages;
        EXPECT_EQ(image_of_motion(scene, options, accel).rgb, serial) << accel;
      }
      options.stages = Stages::automatic, options.finish_paths = {}, options.pool_size = 0;
    }
  }
}

TEST(MovingSpheres, AreTheMeanOfScenesThatStandStill) {
  const SceneData scene = moving_spheres();
  expect_mean_of_still(scene, motion_options(32, 24, 32, 3), held(scene));
}

TEST(MovingSpheres, KeepTheirRadius) {
  SceneData scene = ball_scene(translate({3, 0, 0}), translate({9, 0, 0}) * scale(Vec3(1.5f)));
  try {
    prepare_motion(scene);
    ADD_FAILURE() << "not refused";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("sphere 0 is scaled while it moves"),
              std::string::npos)
        << error.what();
  }
  scene.motion.spheres[0].sphere = 1;
  EXPECT_THROW(prepare_motion(scene), Error);
}

}  // namespace
}  // namespace pt
