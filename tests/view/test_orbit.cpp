// Cameras that are led about what they look at, against rotations by quaternions and by hand.
#include <gtest/gtest.h>

#include <cstring>
#include <glm/gtc/quaternion.hpp>

#include "view/change_settings.h"

namespace {

using namespace pt;

CameraParameters camera_at(const Vec3& from, const Vec3& at, const Vec3& up) {
  CameraParameters camera;
  camera.look_from = from, camera.look_at = at, camera.up = up;
  return camera;
}

CameraParameters skewed() { return camera_at({3, 2, 7}, {1, -1, 0.5f}, {0.2f, 2, -0.3f}); }

double elevation_of(const CameraParameters& camera) {
  const glm::dvec3 offset = glm::dvec3(camera.look_from) - glm::dvec3(camera.look_at);
  const double cosine = glm::dot(glm::normalize(offset), glm::normalize(glm::dvec3(camera.up)));
  return 90 - glm::degrees(std::acos(cosine));
}

void expect_near(const Vec3& found, const Vec3& expected) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[i], expected[i], 1e-5f) << "axis " << i;
}

TEST(Orbit, AtRestNothingChanges) {
  const CameraParameters camera = skewed(), moved = orbit_camera(camera, {});
  EXPECT_EQ(std::memcmp(&camera.look_from, &moved.look_from, sizeof camera.look_from), 0);
  EXPECT_EQ(camera.focus_distance, moved.focus_distance);
}

TEST(Orbit, GoesToTheRightAndUp) {
  const CameraParameters camera = camera_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0});  // its right is +x
  expect_near(orbit_camera(camera, {90, 0, 1}).look_from, {5, 0, 0});
  expect_near(orbit_camera(camera, {180, 0, 2}).look_from, {0, 0, -10});
  expect_near(orbit_camera(camera, {0, 30, 1}).look_from, {0, 2.5f, 4.330127f});
  CameraParameters mirrored = camera;
  mirrored.mirrored = true;  // its right is -x
  expect_near(orbit_camera(mirrored, {90, 0, 1}).look_from, {-5, 0, 0});
}

TEST(Orbit, IsARotationAboutTheUpVectorAfterOneAboutTheSide) {
  const CameraParameters camera = skewed();
  const glm::vec3 up = glm::normalize(camera.up), offset = camera.look_from - camera.look_at;
  const glm::vec3 side = glm::normalize(glm::cross(up, offset));
  for (const double yaw : {-200.0, -30.0, 0.0, 75.0}) {
    for (const double pitch : {-60.0, -10.0, 0.0, 25.0}) {
      const glm::quat turn = glm::angleAxis(static_cast<float>(glm::radians(yaw)), up) *
                             glm::angleAxis(static_cast<float>(glm::radians(-pitch)), side);
      const CameraParameters moved = orbit_camera(camera, {yaw, pitch, 1.5});
      expect_near(moved.look_from, camera.look_at + 1.5f * (turn * offset));
      expect_near(moved.look_at, camera.look_at);
      expect_near(moved.up, camera.up);
    }
  }
}

TEST(Orbit, StaysAwayFromThePoles) {
  EXPECT_NEAR(elevation_of(orbit_camera(skewed(), {20, 180, 1})), 89, 1e-3);
  EXPECT_NEAR(elevation_of(orbit_camera(skewed(), {20, -180, 1})), -89, 1e-3);
  const CameraParameters steep = camera_at({0, 10, 0.01f}, {0, 0, 0}, {0, 1, 0});
  const double elevation = elevation_of(steep);
  EXPECT_GT(elevation, 89.9);
  EXPECT_NEAR(elevation_of(orbit_camera(steep, {0, 45, 1})), elevation, 1e-3);
  EXPECT_NEAR(elevation_of(orbit_camera(steep, {90, 0, 1})), elevation, 1e-3);
  const PitchRange range = pitch_range(skewed());
  EXPECT_NEAR(range.most, 89 - elevation_of(skewed()), 1e-4);
  EXPECT_NEAR(range.least, -89 - elevation_of(skewed()), 1e-4);
}

TEST(Orbit, TheFocusAndAnOrthographicViewFollowTheDistance) {
  CameraParameters camera = skewed();
  camera.focus_distance = 3, camera.orthographic_size = {4, 2};
  const CameraParameters moved = orbit_camera(camera, {10, 0, 0.5});
  EXPECT_FLOAT_EQ(moved.focus_distance, 1.5f);
  EXPECT_FLOAT_EQ(moved.orthographic_size.x, 2.0f);
  EXPECT_FLOAT_EQ(moved.orthographic_size.y, 1.0f);
}

}  // namespace
