// Whole paths, through the serial renderer, against analytic radiances and the furnace.
#include <gtest/gtest.h>

#include "common/scene/builtin/builtin_scenes.h"
#include "common/scene/prepare/prepare_scene.h"
#include "render_serial.h"
#include "scene/small_scenes.h"
#include "statistics.h"

namespace pt {
namespace {

/// All pixels' means in one channel.
MeanEstimate channel(const Image& image, int c) {
  MeanEstimate estimate;
  for (std::size_t i = static_cast<std::size_t>(c); i < image.rgb.size(); i += 3)
    estimate.add(image.rgb[i]);
  return estimate;
}

void expect_all(const Image& image, const Color& expected, double tolerance) {
  for (std::size_t i = 0; i < image.rgb.size(); ++i) {
    ASSERT_NEAR(image.rgb[i], expected[static_cast<int>(i % 3)], tolerance) << "value " << i;
  }
}

/// A unit sphere at the origin that fills the view from (3, 4, 12), under a constant sky.
SceneData lone_sphere(const MaterialDescription& material,
                      const Sky& sky = {Color(1.0f), Color(1.0f)}) {
  SceneData scene;
  scene.add_sphere({0, 0, 0}, 1, scene.add_material(material));
  scene.sky = sky;
  scene.camera = {{3, 4, 12}, {0, 0, 0}, {0, 1, 0}, 0.5f, 0, 13};
  prepare_scene(scene);
  return scene;
}

TEST(LoneSphere, ReflectsItsAlbedoOfAConstantSky) {
  const Color rho(0.2f, 0.5f, 0.9f);
  const Options options = image_options(16, 8, 16);
  for (const MaterialDescription& material : {make_diffuse(rho), make_metal(rho, 0)}) {
    expect_all(render(lone_sphere(material), options).image, rho, 1e-6);
  }
  expect_all(render(lone_sphere(make_dielectric(Color(1.0f), 1.5f)), options).image, Color(1.0f),
             1e-6);
}

// The cosine-weighted mean of the gradient over the hemisphere of n is at height 1/2 + n.y / 3.
TEST(LoneSphere, AveragesAGradient) {
  const Sky sky{{1, 0.2f, 0}, {0, 0.4f, 2}};
  const Image image =
      render(lone_sphere(make_diffuse(Color(0.5f)), sky), image_options(16, 16, 256)).image;
  const double height = 0.5 + 4.0 / 13 / 3;
  for (int c = 0; c < 3; ++c) {
    const double expected = 0.5 * ((1 - height) * sky.nadir[c] + height * sky.zenith[c]);
    const MeanEstimate e = channel(image, c);
    EXPECT_NEAR(e.mean(), expected, 5 * e.sigma() + 1e-5);
  }
}

TEST(MaxDepth, CountsRaysTheCamerasIncluded) {
  const SceneData scene = lone_sphere(make_diffuse(Color(0.5f)));
  for (const int depth : {1, 2, 3}) {
    const Render r = render(scene, image_options(8, 8, 4, depth));
    expect_all(r.image, Color(depth == 1 ? 0.0f : 0.5f), 1e-6);
    EXPECT_EQ(r.counts.rays, std::min(depth, 2) * r.counts.paths);
    EXPECT_EQ(r.counts.shadow_rays, 0u);
  }
  Options options = image_options(8, 8, 4, 1);  // Cornell's lamp, from below: emission alone
  options.scene = "cornell";
  options.camera.look_from = {0, 1, 0}, options.camera.look_at = {0, 2, 0},
  options.camera.up = {0, 0, 1};
  options.camera.vertical_fov_degrees = 10;
  const Render lamp = render(make_scene(options), options);
  expect_all(lamp.image, {17, 12, 4}, 1e-5);
  EXPECT_EQ(lamp.counts.shadow_rays, 0u);
}

/// A floor that sees one lamp and nothing else, looked at from the side in one point, the origin.
SceneData lit_floor() {
  SceneData scene;
  scene.add_quad({-9, 0, -9}, {0, 0, 18}, {18, 0, 0},
                 scene.add_material(make_diffuse({0.25f, 0.5f, 1})));
  scene.add_material(make_diffuse(Color(0.0f), {3, 2, 1}));
  scene.camera = {{5, 3, 0}, {0, 0, 0}, {0, 1, 0}, 0.02f, 0, 5};
  return scene;
}

TEST(DirectLight, FollowsTheFormFactors) {
  // (r / d)^2 cos for the sphere, four corner rectangles for the parallel square above.
  SceneData sphere = lit_floor(), quad = lit_floor();
  sphere.add_sphere({-3, 4, 0}, 2, 1);
  const double sphere_factor = 4.0 / 25 * 0.8;
  quad.add_quad({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, 1);  // faces down
  const double x = 1 / std::sqrt(1.0 + 4), quarter = 2 * x * std::atan(x) / (2 * pi_double);
  for (const auto& [scene, factor] : {std::pair{&sphere, sphere_factor}, {&quad, 4 * quarter}}) {
    prepare_scene(*scene);
    for (const int depth : {2, 50}) {
      const Render r = render(*scene, image_options(16, 16, 256, depth));
      EXPECT_GT(r.counts.shadow_rays, r.counts.paths * 9 / 10);
      for (int c = 0; c < 3; ++c) {
        const double expected =
            scene->materials[0].color(0)[c] * scene->materials[1].emission.radiance[c] * factor;
        const MeanEstimate e = channel(r.image, c);
        EXPECT_NEAR(e.mean(), expected, 5 * e.sigma() + 1e-4 * expected);
        EXPECT_LT(e.sigma(), 5e-3 * expected) << "too noisy to tell";
      }
    }
  }
}

TEST(DirectLight, ComesFromTheSideOfTheNormalAlone) {
  SceneData scene = lit_floor();
  scene.add_quad({-1, 2, -1}, {0, 0, 2}, {2, 0, 0}, 1);  // faces up
  prepare_scene(scene);
  expect_all(render(scene, image_options(8, 8, 16)).image, Color(0.0f), 0);
  scene.camera = {{0, 5, 0}, {0, 2, 0}, {0, 0, 1}, 5, 0, 3};
  expect_all(render(scene, image_options(8, 8, 4)).image, {3, 2, 1}, 1e-5);
  scene.camera.look_from = {0, 1, 0};  // from behind
  expect_all(render(scene, image_options(8, 8, 4)).image, Color(0.0f), 0);
}

TEST(DirectLight, IsStoppedByWhatLiesBetweenAndByNothingElse) {
  for (const float height : {-0.5f, 0.1f, 1.0f, 1.9f, 1.99f, 2.1f}) {
    SceneData scene = lit_floor();
    scene.add_quad({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, 1);  // faces down
    const float half = 0.6f * height;                      // just enough to hide the lamp
    scene.add_quad({-half, height, -half}, {2 * half, 0, 0}, {0, 0, 2 * half},
                   scene.add_material(make_diffuse(Color(0.0f))));
    prepare_scene(scene);
    const double mean = channel(render(scene, image_options(8, 8, 16)).image, 0).mean();
    const bool between = height > 0 && height < 2;
    EXPECT_EQ(mean == 0, between) << "at height " << height;
  }
}

TEST(Furnace, EveryPixelIsOne) {
  Options options = image_options(16, 8, 16, 30);
  options.scene = "furnace";
  for (const AccelKind accel : {AccelKind::brute, AccelKind::bvh2}) {
    options.accel = accel;
    const SceneData scene = make_scene(options);
    std::vector<MeanEstimate> values(static_cast<std::size_t>(3 * options.width * options.height));
    MeanEstimate mean;
    for (options.seed = 1; options.seed <= 32; ++options.seed) {
      options.rng = options.seed % 2 ? RngKind::philox : RngKind::xorwow;
      const Image image = render(scene, options).image;
      for (std::size_t i = 0; i < values.size(); ++i) values[i].add(image.rgb[i]);
      mean.add(channel(image, 0).mean());
    }
    EXPECT_NEAR(mean.mean(), 1, 5 * mean.sigma());
    EXPECT_LT(mean.sigma(), 2e-3) << "too noisy to tell";
    for (const MeanEstimate& v : values) EXPECT_NEAR(v.mean(), 1, 5 * v.sigma() + 1e-5);
  }
}

TEST(Energy, IsNeverCreated) {
  for (const char* name : {"spheres", "rtow"}) {
    for (const bool white : {false, true}) {
      Options options = image_options(48, 24, 16);
      options.scene = name;
      SceneData scene = make_scene(options);
      if (white) {
        scene.sky = {Color(1.0f), Color(1.0f)};
        for (MaterialDescription& m : scene.materials) m.parameters[0].value = Color(1.0f);
        prepare_scene(scene, options);
      }
      for (const float value : render(scene, options).image.rgb) {
        ASSERT_GE(value, 0.0f);
        ASSERT_LE(value, 1 + 1e-5f) << name;
      }
    }
  }
}

TEST(Accel, DoesNotChangeTheImage) {
  for (const std::string& name : primitive_scenes()) {
    Options options = image_options(48, 24, 8);
    options.scene = name;
    std::vector<Render> renders;
    for (const AccelKind accel : {AccelKind::brute, AccelKind::bvh2}) {
      options.accel = accel;
      renders.push_back(render(make_scene(options), options));
    }
    EXPECT_EQ(renders[0].image.rgb, renders[1].image.rgb) << name;
    EXPECT_EQ(renders[0].counts.rays, renders[1].counts.rays) << name;
  }
}

}  // namespace
}  // namespace pt
