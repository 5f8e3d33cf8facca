// The camera against the textbook's formulas in double precision, and the check of its parameters.
#include <gtest/gtest.h>

#include "common/error/error.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/scene/prepare/prepare_steps.h"
#include "statistics.h"
#include "temp_folder.h"

namespace pt {
namespace {

using Vec3d = glm::dvec3;

CameraParameters random_parameters(TestRandom& random) {
  CameraParameters camera;
  for (int i = 0; i < 3; ++i) {
    camera.look_from[i] = static_cast<float>(random.uniform(-20, 20));
    camera.look_at[i] = static_cast<float>(random.uniform(-20, 20));
    camera.up[i] = static_cast<float>(random.uniform(-1, 1));
  }
  camera.fov_degrees = static_cast<float>(random.uniform(2, 150));
  camera.focus_distance = static_cast<float>(random.log_uniform(0.1, 100));
  camera.aperture = static_cast<float>(random.uniform(0, 2));
  return camera;
}

/// Right, up and forward of a camera.
struct Axes {
  Vec3d right, up, forward;
};

Axes exact_axes(const CameraParameters& c) {
  const Vec3d forward = glm::normalize(Vec3d(c.look_at) - Vec3d(c.look_from));
  const Vec3d right = glm::normalize(glm::cross(forward, Vec3d(c.up)));
  return {right, glm::cross(right, forward), forward};
}

/// Direction through the film point (s, t), each in [-1, 1], to the right and up.
Vec3d pinhole_direction(const CameraParameters& c, double aspect, double s, double t) {
  const Axes axes = exact_axes(c);
  const double half_height = std::tan(c.fov_degrees * pi_double / 360);
  return glm::normalize(axes.forward + s * aspect * half_height * axes.right +
                        t * half_height * axes.up);
}

bool well_conditioned(const CameraParameters& c) {
  const Vec3d view = Vec3d(c.look_at) - Vec3d(c.look_from);
  return glm::length(view) > 1 && glm::length(glm::cross(glm::normalize(view), Vec3d(c.up))) > 0.2;
}

TEST(Camera, APlainViewByHand) {
  const Camera camera = make_camera({{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 90, 0, 1}, 200, 100);
  const auto direction = [&](float x, float y) { return camera_ray(camera, x, y, 0, 0).direction; };
  const auto expect_along = [](const Vec3& d, const Vec3d& expected) {
    EXPECT_LE(glm::length(Vec3d(d) - glm::normalize(expected)), 1e-6);
  };
  expect_along(direction(100, 50), {0, 0, -1});
  expect_along(direction(0, 0), {-2, 1, -1});  // the upper left corner: 45 degrees up
  expect_along(direction(200, 0), {2, 1, -1});
  expect_along(direction(0, 100), {-2, -1, -1});
  expect_along(direction(200, 100), {2, -1, -1});
  EXPECT_EQ(camera_ray(camera, 3, 4, 0.3f, 0.7f).origin, Vec3(0, 0, 5)) << "a pinhole";
}

TEST(Camera, PinholeRaysAreTheTextbooks) {
  TestRandom random;
  for (int i = 0; i < 20'000; ++i) {
    CameraParameters parameters = random_parameters(random);
    if (!well_conditioned(parameters)) continue;
    parameters.aperture = 0;
    const int width = 50 + static_cast<int>(random.below(3000));
    const int height = 1 + static_cast<int>(width * random.uniform(0.2, 5));
    const double aspect = static_cast<double>(width) / height;
    const Camera camera = make_camera(parameters, width, height);
    for (const auto& [s, t] : {std::pair{0., 0.},
                               {-1., 1.},
                               {1., 1.},
                               {-1., -1.},
                               {1., -1.},
                               {random.uniform(-1, 1), random.uniform(-1, 1)}}) {
      const auto x = static_cast<float>(0.5 * (s + 1) * width);
      const auto y = static_cast<float>(0.5 * (1 - t) * height);
      const Ray ray = camera_ray(camera, x, y, random.unit(), random.unit());
      ASSERT_EQ(ray.origin, parameters.look_from);
      ASSERT_NEAR(glm::length(Vec3d(ray.direction)), 1, 1e-6);
      ASSERT_LE(glm::length(Vec3d(ray.direction) - pinhole_direction(parameters, aspect, s, t)),
                1e-5);
    }
  }
}

TEST(Camera, ResolutionOnlyDividesTheSameView) {
  TestRandom random(2);
  for (int i = 0; i < 2'000; ++i) {
    const CameraParameters parameters = random_parameters(random);
    if (!well_conditioned(parameters)) continue;
    const Camera coarse = make_camera(parameters, 40, 20),
                 fine = make_camera(parameters, 4000, 2000);
    const auto x = static_cast<float>(random.uniform(0, 40));
    const auto y = static_cast<float>(random.uniform(0, 20));
    const float u = random.unit(), v = random.unit();
    const Ray a = camera_ray(coarse, x, y, u, v), b = camera_ray(fine, 100 * x, 100 * y, u, v);
    EXPECT_LE(glm::length(Vec3d(a.direction) - Vec3d(b.direction)), 1e-5);
    EXPECT_EQ(a.origin, b.origin);
  }
}

TEST(Camera, RaysOfOneFilmPointMeetInTheFocalPlane) {
  TestRandom random(3);
  for (int i = 0; i < 2'000; ++i) {
    const CameraParameters parameters = random_parameters(random);
    if (!well_conditioned(parameters)) continue;
    const Camera camera = make_camera(parameters, 300, 200);
    const Axes axes = exact_axes(parameters);
    const double s = random.uniform(-1, 1), t = random.uniform(-1, 1);
    const Vec3d chief = pinhole_direction(parameters, 1.5, s, t);
    const Vec3d focus = Vec3d(parameters.look_from) +
                        chief * (parameters.focus_distance / glm::dot(chief, axes.forward));
    for (int k = 0; k < 20; ++k) {
      const Ray ray = camera_ray(camera, static_cast<float>(150 * (s + 1)),
                                 static_cast<float>(100 * (1 - t)), random.unit(), random.unit());
      const Vec3d lens = Vec3d(ray.origin) - Vec3d(parameters.look_from);
      ASSERT_LE(glm::length(lens), 0.5 * parameters.aperture + 1e-5);
      ASSERT_NEAR(glm::dot(lens, axes.forward), 0, 1e-5) << "a lens point off the lens";
      const Vec3d to_focus = focus - Vec3d(ray.origin);
      ASSERT_LE(glm::length(glm::normalize(to_focus) - Vec3d(ray.direction)),
                1e-5 * (1 + 20 / glm::length(to_focus)));
    }
  }
}

// For any kind of camera, at the image's corners, too; and hardly more.
TEST(CameraExtent, HoldsWhereRaysBegin) {
  TestRandom random(8);
  for (int i = 0; i < 300; ++i) {
    CameraParameters parameters = random_parameters(random);
    if (!well_conditioned(parameters)) continue;
    parameters.aperture *= static_cast<float>(i % 2);
    parameters.near_clip = i % 3 == 0 ? 0.0f : static_cast<float>(random.log_uniform(0.01, 10));
    parameters.orthographic = i % 5 == 0;
    parameters.orthographic_size = {3.0f, 1.0f};
    parameters.principal_point = {static_cast<float>(random.uniform(-0.3, 0.3)), 0.1f};
    const int width = 40 + i % 40, height = 130 - 2 * (i % 40);
    const Camera camera = make_camera(parameters, width, height);
    const float extent = camera_extent(parameters, width, height);
    float most = 0;
    for (int k = 0; k < 400; ++k) {
      const bool is_corner = k < 100;
      const auto u = [&] { return static_cast<float>(random.unit()); };
      const float x =
          is_corner ? k % 2 * static_cast<float>(width) : u() * static_cast<float>(width);
      const float y =
          is_corner ? k / 2 % 2 * static_cast<float>(height) : u() * static_cast<float>(height);
      const Ray ray = camera_ray(camera, x, y, u(), u());
      most = std::max(most, glm::length(ray.origin - parameters.look_from));
    }
    ASSERT_LE(most, extent) << i;
    ASSERT_LE(extent, 3.2f * most + 1e-4f) << i;
  }
}

TEST(Camera, TheLensIsUniform) {
  const CameraParameters parameters{{0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 40, 3, 2};
  const Camera camera = make_camera(parameters, 10, 10);
  TestRandom random(4);
  constexpr int n = 16, samples = 200'000;
  std::vector<double> counts(n * n);
  for (int i = 0; i < samples; ++i) {
    const Vec3 p = camera_ray(camera, 5, 5, random.unit(), random.unit()).origin / 1.5f;
    ++counts[n * cell_of(p.x * p.x + p.y * p.y, n) +
             cell_of(std::atan2(p.y, p.x) / (2 * pi_double) + 0.5, n)];
  }
  expect_uniform(counts, samples, "lens");
}

/// A scene of one sphere, prepared with camera overrides.
SceneData prepare(const CameraOverrides& overrides) {
  SceneData scene;
  scene.add_sphere({0, 0, 0}, 1, scene.add_material(MaterialDescription()));
  scene.camera = {{0, 0, 9}, {0, 0, 0}, {0, 1, 0}, 40, 0.5f, 7};
  Options options;
  options.camera = overrides;
  prepare_scene(scene, options);
  return scene;
}

TEST(CameraOptions, ReplaceTheScenesValues) {
  const CameraParameters kept = prepare({}).camera;
  EXPECT_EQ(kept.look_from, Vec3(0, 0, 9));
  EXPECT_EQ(kept.focus_distance, 7.0f);
  CameraOverrides all;
  all.look_from = {1, 2, 3}, all.look_at = {4, 5, 6}, all.up = {0, 0, 1};
  all.vertical_fov_degrees = 50, all.aperture = 0.25f, all.focus_distance = 8;
  const CameraParameters c = prepare(all).camera;
  EXPECT_EQ(c.look_from, Vec3(1, 2, 3));
  EXPECT_EQ(c.look_at, Vec3(4, 5, 6));
  EXPECT_EQ(c.up, Vec3(0, 0, 1));
  EXPECT_EQ((std::vector{c.fov_degrees, c.aperture, c.focus_distance}),
            (std::vector{50.0f, 0.25f, 8.0f}));
}

TEST(Camera, TheFixedAxisKeepsItsAngle) {
  CameraParameters c{{0, 0, 5}, {0, 0, 0}};
  c.fov_degrees = 90;  // half a side is as long as the distance
  const auto expect = [&](FovAxis axis, int width, int height, double half_height) {
    c.fov_axis = axis;
    EXPECT_NEAR(vertical_tangent(c, width, height), half_height, 1e-6);
    const Camera camera = make_camera(c, width, height);
    EXPECT_NEAR(camera.corner.y, half_height, 1e-6);
    EXPECT_NEAR(camera.corner.x, -half_height * width / height, 1e-6);
  };
  for (const auto& [width, height] : {std::pair{160, 90}, {90, 90}, {90, 160}}) {
    const double smaller = std::min(width, height), larger = std::max(width, height);
    expect(FovAxis::vertical, width, height, 1);
    expect(FovAxis::horizontal, width, height, double(height) / width);
    expect(FovAxis::smaller, width, height, height / smaller);
    expect(FovAxis::larger, width, height, height / larger);
    expect(FovAxis::diagonal, width, height, height / std::hypot(width, height));
  }
}

TEST(CameraOptions, TheAngleIsVertical) {
  CameraParameters c;
  c.fov_axis = FovAxis::horizontal;
  CameraOverrides overrides;
  override_camera(c, overrides);
  EXPECT_EQ(c.fov_axis, FovAxis::horizontal);
  overrides.vertical_fov_degrees = 50;
  override_camera(c, overrides);
  EXPECT_EQ(c.fov_axis, FovAxis::vertical);
}

TEST(CameraOptions, APinholeHasNoFocus) {
  CameraParameters pinhole;
  pinhole.aperture = 0;
  CameraOverrides overrides;
  overrides.focus_distance = 3;
  expect_error([&] { override_camera(pinhole, overrides); },
               "--focus-distance 3: has no effect in the scene's pinhole camera");
  overrides.aperture = 0.1f;
  override_camera(pinhole, overrides);
  EXPECT_EQ(pinhole.focus_distance, 3.0f);
}

TEST(CameraOptions, ErrorsNameTheOption) {
  const auto expect = [](const char* option, const auto& change) {
    CameraOverrides overrides;
    change(overrides);
    expect_error([&] { prepare(overrides); }, option);
  };
  const float nan = std::nanf("");
  expect("--look-from", [](auto& o) { o.look_from = {0, 0, 0}; });
  expect("--look-at", [](auto& o) { o.look_at = {0, 0, 9}; });
  expect("--up", [](auto& o) { o.up = {0, 0, 0}; });
  expect("--up", [](auto& o) { o.up = {0, 0, -3}; });
  for (const float bad : {0.0f, -10.0f, 180.0f, 1000.0f, nan}) {
    expect("--fov", [&](auto& o) { o.vertical_fov_degrees = bad; });
  }
  for (const float bad : {-0.1f, nan}) expect("--aperture", [&](auto& o) { o.aperture = bad; });
  for (const float bad : {0.0f, -1.0f, nan}) {
    expect("--focus-distance", [&](auto& o) { o.focus_distance = bad; });
  }
}

}  // namespace
}  // namespace pt
