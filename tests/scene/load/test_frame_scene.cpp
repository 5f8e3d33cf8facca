// The camera of files that bring none.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/scene/data/scene_data.h"

namespace pt {
namespace {

/// How far a point is off the image's middle, by half of its smaller side.
float off_middle(const CameraParameters& parameters, int width, int height, const Vec3& p) {
  const Camera camera = make_camera(parameters, width, height);
  const Vec3 forward = normalize(parameters.look_at - parameters.look_from);
  const Vec3 d = p - camera.origin;
  const Vec3 from_corner = d * (parameters.focus_distance / glm::dot(d, forward)) - camera.corner;
  const auto along = [&](const Vec3& step, int size) {
    return std::abs(glm::dot(from_corner, step) / glm::dot(step, step) - 0.5f * size);
  };
  return std::max(along(camera.step_x, width), along(camera.step_y, height)) /
         (0.5f * std::min(width, height));
}

/// Checks all of a scene's points, in images of three shapes.
void expect_filled(const SceneData& scene, const std::vector<Vec3>& points) {
  const CameraParameters camera = frame_scene(scene);
  for (const auto& [width, height] : {std::pair{300, 100}, {100, 100}, {100, 400}}) {
    float widest = 0;
    for (const Vec3& p : points) {
      widest = std::max(widest, off_middle(camera, width, height, p));
    }
    EXPECT_NEAR(widest, 0.95f, 1e-3f);
  }
}

TEST(FrameScene, FillsImagesOfAnyShape) {
  for (const Vec3& half : {Vec3(1, 1, 1), Vec3(100, 1, 1), Vec3(1, 50, 1), Vec3(3, 0, 2)}) {
    SceneData scene;
    Mesh mesh;
    for (int i = 0; i < 8; ++i) {
      mesh.positions.push_back(Vec3(7) +
                               half * Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
    }
    scene.meshes.push_back(mesh);
    expect_filled(scene, mesh.positions);
    // The same as a group, once.
    scene.meshes[0].group = 1;
    Instance instance{1, {}};
    instance.to_world.row[0].w = 30;
    scene.instances.push_back(instance);
    for (Vec3& p : mesh.positions) p.x += 30;
    expect_filled(scene, mesh.positions);
  }
}

TEST(FrameScene, ABallTouchesTheSameFrame) {
  SceneData scene;
  scene.add_sphere({5, 6, 7}, 2, scene.add_material(MaterialDescription()));
  std::vector<Vec3> surface;
  for (int i = 0; i <= 400; ++i) {
    for (int j = 0; j < 400; ++j) {
      const float t = pi * i / 400, f = 2 * pi * j / 400;
      surface.push_back(Vec3(5, 6, 7) + 2.0f * Vec3(std::sin(t) * std::cos(f), std::cos(t),
                                                    std::sin(t) * std::sin(f)));
    }
  }
  expect_filled(scene, surface);
}

TEST(FrameScene, AQuadFillsItsFrame) {
  SceneData scene;
  scene.add_quad({1, 2, 3}, {4, 0, 0}, {0, 5, 1}, scene.add_material(MaterialDescription()));
  std::vector<Vec3> box;  // that it is in
  for (int i = 0; i < 8; ++i) box.emplace_back(i & 1 ? 5 : 1, i & 2 ? 7 : 2, i & 4 ? 4 : 3);
  expect_filled(scene, box);
  const CameraParameters camera = frame_scene(scene);
  EXPECT_EQ(camera.look_at, Vec3(3, 4.5f, 3.5f));
  const Vec3 way = camera.look_from - camera.look_at;
  EXPECT_NEAR(glm::length(way), camera.focus_distance, 1e-4f);
  const Vec3 expected = glm::length(way) * glm::normalize(Vec3(1.0f, 0.7f, 1.5f));
  EXPECT_NEAR(glm::length(way - expected), 0, 1e-4f) << "from the front, right and above";
}

}  // namespace
}  // namespace pt
