// What lies between a camera and its near plane, of what an image shows.
#include <gtest/gtest.h>

#include "accel/triangle_rays.h"
#include "common/geometry/triangle.h"
#include "common/scene/prepare/near_space.h"

namespace pt {
namespace {

CameraParameters camera_at_origin() {
  CameraParameters camera;
  camera.look_from = Vec3(0), camera.look_at = {0, 0, -1}, camera.up = {0, 1, 0};
  camera.fov_degrees = 90, camera.near_clip = 0.01f;
  return camera;
}

/// Parallel to the direction of view, `distance` beside the camera.
bool meets_wall(const NearSpace& space, float distance) {
  return space.meets({distance, -1, 1}, {distance, -1, -3}, {distance, 2, -1});
}

TEST(NearSpace, EndsWhereTheImageDoes) {
  const NearSpace square(camera_at_origin(), 512, 512), wide(camera_at_origin(), 1024, 512);
  EXPECT_FALSE(meets_wall(square, 0.0105f));  // not seen before it is 0.0105 away
  EXPECT_TRUE(meets_wall(square, 0.0095f));
  EXPECT_TRUE(meets_wall(wide, 0.0105f));
  EXPECT_FALSE(square.meets({-1, -1, -0.0101f}, {1, -1, -0.0101f}, {0, 2, -0.0101f}));
  EXPECT_TRUE(square.meets({-1, -1, -0.0099f}, {1, -1, -0.0099f}, {0, 2, -0.0099f}));
  EXPECT_FALSE(square.meets({-1, -1, 0.001f}, {1, -1, 0.001f}, {0, 2, 0.001f}));
}

TEST(NearSpace, GrowsWithTheLens) {
  CameraParameters camera = camera_at_origin();
  camera.aperture = 0.002f, camera.focus_distance = 1;
  EXPECT_TRUE(meets_wall(NearSpace(camera, 512, 512), 0.0105f));
  EXPECT_FALSE(meets_wall(NearSpace(camera, 512, 512), 0.0125f));
}

// Whatever a camera ray meets before the near plane is found, and little besides.
TEST(NearSpace, HoldsWhatCameraRaysMeet) {
  TestRandom random(5);
  int met = 0, found = 0;
  for (const bool orthographic : {false, true}) {
    for (int i = 0; i < 3000; ++i) {
      CameraParameters parameters = camera_at_origin();
      parameters.look_from = point_in_cube(random, 10);
      parameters.look_at = parameters.look_from + point_in_cube(random, 1);
      parameters.up = point_in_cube(random, 1);
      parameters.fov_degrees = static_cast<float>(random.uniform(10, 120));
      parameters.orthographic = orthographic, parameters.orthographic_size = {0.02f, 0.02f};
      parameters.principal_point = {static_cast<float>(random.uniform(-0.3, 0.3)), 0};
      parameters.aperture = random.bits() % 2 == 0 ? 0.0f : 0.01f;
      const Camera camera = make_camera(parameters, 48, 32);
      const Vec3 at = parameters.look_from + point_in_cube(random, 0.02f);
      const Vec3 a = at + point_in_cube(random, 0.02f), b = at + point_in_cube(random, 0.02f);
      const Vec3 c = at + point_in_cube(random, 0.02f);
      bool is_met = false;
      for (int k = 0; k < 400 && !is_met; ++k) {
        const auto u = [&] { return static_cast<float>(random.unit()); };
        const Ray ray = camera_ray(camera, 48 * u(), 32 * u(), u(), u());
        const TriangleRay prepared = make_triangle_ray(ray.origin, ray.direction);
        const float t = intersect_triangle(prepared, a, b, c).t;
        is_met = t > 0 && dot(t * ray.direction, camera.forward) <= parameters.near_clip;
      }
      const bool is_found = NearSpace(parameters, 48, 32).meets(a, b, c);
      ASSERT_TRUE(is_found || !is_met) << i;
      met += is_met ? 1 : 0, found += is_found ? 1 : 0;
    }
  }
  EXPECT_GT(met, 300);
  EXPECT_LT(found, 2 * met);
}

}  // namespace
}  // namespace pt
