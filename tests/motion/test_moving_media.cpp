// Masks, media and limits of the view in scenes that move, against integrals over time in closed
// form and against renders of scenes that stand still.
#include <gtest/gtest.h>

#include "common/film/aov.h"
#include "common/scene/prepare/prepare_steps.h"
#include "medium/moving_fog.h"
#include "scene/motion_images.h"

namespace pt {
namespace {

SceneData moving_band(float way = 6) {
  SceneData scene = band_scene();
  scene.motion.instances = {{0, {{0.0f, {}}, {1.0f, translate({way, 0, 0})}}}};
  return scene;
}

TEST(MovingMasks, AreTheirIntegralsOverTime) {
  SceneData scene = moving_band();
  scene.materials[0].opacity = constant_opacity(0.5f);  // which emission is scaled by, too
  for (const char* accel : {"bvh2", "brute", "cwbvh"})
    expect_band(image_of_motion(scene, motion_options(16, 1, 16384), accel),
                [](int x) { return 0.5 * seen_part(x, 6); });
  scene = moving_band();  // of which the left half is there
  Texture look;
  look.filter = TextureFilter::nearest;
  scene.materials[0].opacity =
      textured_opacity(1.0f, add_picture(scene, 2, 1, {Color(1.0f), Color(0.0f)}, look), 0.5f);
  scene.meshes[0].uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  expect_band(image_of_motion(scene, motion_options(16, 1, 16384)),
              [](int x) { return seen_part(x, 6, 2, 3.5); });
}

TEST(MovingMasks, HideLampsFromTheCamera) {
  SceneData scene = moving_band();
  scene.camera.hides_emitters = true;
  expect_band(image_of_motion(scene, motion_options(16, 1, 64)), [](int) { return 0.0; });
}

TEST(MovingViews, HaveAFarPlaneThatMovesAlong) {
  SceneData scene = band_scene();  // from which the camera goes, behind its far plane after a half
  const Affine place = translate({8, 0, 10});
  scene.camera.far_clip = 12;
  scene.motion.camera = {{0.0f, place}, {1.0f, translate({0, 0, 4}) * place}};
  expect_band(image_of_motion(scene, motion_options(16, 1, 16384)),
              [](int x) { return x >= 2 && x < 5 ? 0.5 : 0.0; });
}

TEST(MovingViews, HaveAFarPlaneThatTurns) {
  SceneData scene = band_scene();
  const Affine place = translate({8, 0, 10});
  scene.camera.far_clip = 12;
  scene.motion.camera = {{0.0f, place}, {1.0f, place * rotate({0, 1, 0}, 60)}};
  Options options = motion_options(16, 1, 1);
  prepare_scene_for(scene, options, cpu_of_motion());
  const Scene view = host_view(scene, 16, 1);
  for (const float time : {0.0f, 0.25f, 1.0f}) {
    const double angle = double{time} * pi_double / 3;
    const Vec3 forward(-std::sin(angle), 0, -std::cos(angle));
    EXPECT_NEAR(ray_length<true>(view, forward, 1, time), 12, 1e-4) << time;
    EXPECT_EQ(ray_length<true>(view, forward, 0, time), infinite_distance);
  }
}

TEST(MovingMedia, DimWhatAMovingCameraSees) {
  SceneData scene = band_scene();
  scene.media = {make_medium({0.1f, 0.2f, 0.4f}, Color(0.0f))};
  scene.camera_medium = 0;
  const Affine place = translate({8, 0, 10});
  scene.motion.camera = {{0.0f, place}, {1.0f, translate({0, 0, -8}) * place}};
  Options options = motion_options(16, 1, 16384);
  options.aovs = aov_bit<aov::Transmittance> | aov_bit<aov::Depth>;
  for (const Mode mode : {Mode::megakernel, Mode::wavefront}) {
    options.mode = mode;
    const Image image = image_of_motion(scene, options);
    const std::vector<float>& passed =
        image.layers[0].name == "transmittance" ? image.layers[0].values : image.layers[1].values;
    for (int x = 2; x < 5; ++x)
      for (int c = 0; c < 3; ++c) {  // the mean of exp(-s d) for d from 10 to 2
        const double s = double{scene.media[0].extinction[c]};
        const double expected = (std::exp(-2 * s) - std::exp(-10 * s)) / (8 * s);
        EXPECT_NEAR(image.pixel(x, 0)[c], expected, 0.015) << x << ' ' << c;
        EXPECT_NEAR(passed[static_cast<std::size_t>(3 * x + c)], expected, 2e-3) << x << ' ' << c;
      }
    for (const ImageLayer& layer : image.layers) {
      if (layer.name == "depth") {
        EXPECT_NEAR(layer.values[3], 6, 1e-4);  // halfway
      }
    }
  }
}

TEST(MovingMedia, GoWithTheirBoundaries) {
  SceneData scene = moving_band();
  scene.media = {make_medium(Color(0.5f), Color(0.0f))};
  scene.sky.nadir = scene.sky.zenith = Color(1.0f);
  Mesh slab;
  add_box(slab, translate({3.5f, 0, 0}) * scale({1.5f, 9, 1}));
  slab.material = 0, slab.group = 1;
  const double absorbed = 1 - std::exp(-0.5 * 2);
  const auto expected = [&](int x) { return 1 - absorbed * seen_part(x, 6); };
  scene.materials[0] = make_boundary(no_medium, 0);
  scene.meshes = {slab};
  expect_band(image_of_motion(scene, motion_options(16, 1, 16384)), expected);
  SceneData deforming = scene;  // on its way, too
  deforming.motion.instances.clear();
  deforming.meshes[0].later_positions = {slab.positions};
  for (Vec3& p : deforming.meshes[0].later_positions[0]) p.x += 6;
  expect_band(image_of_motion(deforming, motion_options(16, 1, 16384)), expected);
  // Shadow rays through it: a floor behind, lit by a sun along the camera's rays.
  scene.sky = {};
  scene.meshes.push_back(
      square_of(-99, 99, -99, 99, -5, scene.add_material(make_diffuse(Color(1.0f)))));
  scene.delta_lights = {sun_along({0, 0, -1}, Color(pi))};
  expect_band(image_of_motion(scene, motion_options(16, 1, 16384, 2)), [&](int x) {
    const double twice = 1 - std::exp(-2.0);  // there and back, at the same time
    return 1 - twice * seen_part(x, 6);
  });
}

TEST(MovingMedia, WithGridsAreRefused) {
  SceneData scene = moving_fog_room();
  const auto obstacle = [&scene] {
    SceneData resolved = scene;
    resolve_scene(resolved, Options());
    return motion_obstacle(Options(), resolved.properties, false);
  };
  EXPECT_EQ(obstacle(), "");  // the cloud stands
  scene.media[1].density_grid = scene.media[2].density_grid;
  EXPECT_NE(obstacle().find("does not move with the medium's boundary"), std::string::npos);
  scene.media[1].density_grid = no_grid;
  Mesh& cloud = scene.meshes[4];
  cloud.later_positions = {cloud.positions};
  EXPECT_NE(obstacle(), "");
  cloud.stop_deforming();
  scene.media[0].density_grid = scene.media[2].density_grid;  // around what moves
  EXPECT_EQ(obstacle(), "");
}

TEST(MovingMedia, AreTheSameInAllModesAndStructures) {
  Options options = motion_options(40, 30, 4, 6);
  SceneData stiff = moving_fog_room();  // nothing deforms, so there may be wide trees
  stiff.meshes[3].stop_deforming();
  SceneData masked = moving_room();  // without media
  masked.materials[masked.meshes[1].material].opacity = constant_opacity(0.6f);
  const std::pair<const SceneData, std::vector<std::string>> rooms[] = {
      {moving_fog_room(), {"bvh2", "brute"}},
      {masked, {"bvh2", "brute"}},
      {stiff, {"bvh2", "brute", "cwbvh"}}};
  for (const auto& [room, accels] : rooms) {
    options.mode = Mode::serial;
    const std::vector<float> serial = image_of_motion(room, options).rgb;
    for (const std::string& accel : accels) {
      options.mode = Mode::megakernel;
      EXPECT_EQ(image_of_motion(room, options, accel).rgb, serial) << accel;
      options.mode = Mode::wavefront;
      for (const Stages stages : {Stages::split, Stages::fused}) {
        options.stages = stages, options.finish_paths = 0, options.pool_size = 333;
        EXPECT_EQ(image_of_motion(room, options, accel).rgb, serial) << accel;
      }
      options.stages = Stages::split;
      if (!room.media.empty()) options.wave_collisions = 1;
      EXPECT_EQ(image_of_motion(room, options, accel).rgb, serial) << accel;
      options.stages = Stages::automatic, options.finish_paths = {}, options.pool_size = 0;
      options.wave_collisions = 0;
    }
  }
}

TEST(MovingMedia, AreTheMeanOfScenesThatStandStill) {
  const SceneData room = moving_fog_room();
  expect_mean_of_still(room, motion_options(32, 24, 64, 4), held(room));
}

TEST(MovingMedia, OfWhiteThingsInAWhiteSkyAreWhite) {
  SceneData scene = moving_fog_room();
  for (MaterialDescription& material : scene.materials)
    if (!material.passes) material = make_diffuse(Color(1.0f));
  for (MaterialDescription& material : scene.materials)
    if (material.passes) material.media.outside = no_medium;  // a haze without end hides the sky
  scene.camera_medium = no_medium;
  for (Medium& medium : scene.media) medium.albedo = Color(1.0f);
  scene.camera.hides_emitters = false;
  scene.sky.nadir = scene.sky.zenith = Color(1.0f);
  const Image image = image_of_motion(scene, motion_options(24, 18, 256, 500));
  double sum = 0;
  for (const float value : image.rgb) sum += double{value};
  EXPECT_NEAR(sum / static_cast<double>(image.rgb.size()), 1.0, 3e-3);
}

}  // namespace
}  // namespace pt
