// Cameras that are led about what they look at, against rotations by quaternions and by hand.
#include <gtest/gtest.h>

#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <sstream>

#include "app/options/command_line.h"
#include "common/scene/prepare/prepare_steps.h"
#include "load/mitsuba_scene.h"
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
  camera.focus_distance = 3, camera.aperture = 0.1f, camera.orthographic_size = {4, 2};
  const CameraParameters moved = orbit_camera(camera, {10, 0, 0.5});
  EXPECT_FLOAT_EQ(moved.focus_distance, 1.5f);
  EXPECT_FLOAT_EQ(moved.orthographic_size.x, 2.0f);
  EXPECT_FLOAT_EQ(moved.orthographic_size.y, 1.0f);
}

/// A lens, and a pinhole camera, that have moved.
std::vector<CameraParameters> moved_cameras() {
  CameraParameters lens = skewed(), pinhole = skewed();
  lens.aperture = 0.25f, lens.focus_distance = 3.3f, lens.fov_degrees = 33;
  pinhole.fov_degrees = 71.5f;
  const Orbit orbit{33, -7, 1.3};
  return {lens, orbit_camera(lens, orbit), orbit_camera(pinhole, orbit)};
}

/// Bits of the rays through the image's corners.
std::vector<Ray> corner_rays(const CameraParameters& parameters) {
  const Camera camera = make_camera(parameters, 64, 48);
  std::vector<Ray> rays;
  for (const float x : {0.0f, 64.0f})
    for (const float y : {0.0f, 48.0f}) rays.push_back(camera_ray(camera, x, y, 0.3f, 0.8f));
  return rays;
}

TEST(CameraText, TheOptionsGiveTheSameBits) {
  for (const CameraParameters& camera : moved_cameras()) {
    std::vector<std::string> words{"--scene", "cornell"};
    std::istringstream text(camera_options(camera));
    for (std::string word; text >> word;) words.push_back(word);
    const auto command = std::get<RenderCommand>(parse_command_line(words));
    CameraParameters given;  // another scene's
    given.fov_axis = FovAxis::diagonal;
    override_camera(given, command.options.camera);
    const std::vector<Ray> expected = corner_rays(camera), found = corner_rays(given);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(expected[i].origin, found[i].origin);
      EXPECT_EQ(expected[i].direction, found[i].direction);
    }
  }
}

void expect_same_view(const CameraParameters& camera) {
  SCOPED_TRACE(camera_xml(camera, {640, 480}));
  const SceneData scene =
      load_xml(camera_xml(camera, {640, 480}) + "<shape type='sphere'/><emitter type='constant'/>")
          .scene;
  EXPECT_EQ(scene.defaults.width, 640);
  EXPECT_EQ(scene.defaults.height, 480);
  const std::vector<Ray> expected = corner_rays(camera), found = corner_rays(scene.camera);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(expected[i].origin[c], found[i].origin[c], 2e-4);
      EXPECT_NEAR(expected[i].direction[c], found[i].direction[c], 1e-5);
    }
  }
}

TEST(CameraText, TheSceneLinesSeeTheSame) {
  for (const CameraParameters& camera : moved_cameras()) expect_same_view(camera);
  CameraParameters camera = skewed();
  camera.mirrored = true, camera.principal_point = {0.1f, -0.2f};
  expect_same_view(camera);
  camera.fov_axis = FovAxis::horizontal;
  expect_same_view(camera);
  camera.principal_point = {0, 0}, camera.orthographic = true, camera.orthographic_size = {3, 3};
  expect_same_view(camera);
}

}  // namespace
