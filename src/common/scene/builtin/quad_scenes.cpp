#include "common/scene/builtin/quad_scenes.h"

#include "common/scene/builtin/quad_shapes.h"

namespace pt {
namespace {

constexpr float fog_extinction = 0.5f;  // so that the box is as deep as one mean free path

}  // namespace

SceneData make_cornell_scene() {
  SceneData scene;
  const auto white = scene.add_material(make_diffuse({0.73f, 0.73f, 0.73f}));
  const auto red = scene.add_material(make_diffuse({0.65f, 0.05f, 0.05f}));
  const auto green = scene.add_material(make_diffuse({0.12f, 0.45f, 0.15f}));
  const auto lamp = scene.add_material(make_diffuse(Color(0.0f), {17.0f, 12.0f, 4.0f}));
  scene.add_quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, white);  // floor
  scene.add_quad({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, white);  // ceiling
  scene.add_quad({-1, 0, -1}, {2, 0, 0}, {0, 2, 0}, white);  // back
  scene.add_quad({-1, 0, -1}, {0, 2, 0}, {0, 0, 2}, red);    // left
  scene.add_quad({1, 0, -1}, {0, 0, 2}, {0, 2, 0}, green);   // right
  scene.add_quad({-0.25f, 1.99f, -0.25f}, {0.5f, 0, 0}, {0, 0, 0.5f}, lamp);
  add_quad_box(scene, {-0.35f, 0.6f, -0.3f}, {0.6f, 1.2f, 0.6f}, 17.0f, white);
  add_quad_box(scene, {0.35f, 0.3f, 0.35f}, {0.6f, 0.6f, 0.6f}, -17.0f, white);
  scene.camera = {{0, 1, 4.8f}, {0, 1, 0}, {0, 1, 0}, 30.0f, 0.0f, 4.8f};
  return scene;
}

SceneData make_fog_scene() {
  SceneData scene = make_cornell_scene();
  Medium fog;
  fog.extinction = Color(fog_extinction);
  fog.albedo = {0.95f, 0.93f, 0.9f};
  fog.phase = phase_kind_of<HenyeyGreenstein>;
  fog.phase_parameter = 0.5f;
  scene.media.push_back(fog);
  MaterialDescription front;
  front.is_boundary = front.passes = true;
  front.media = {no_medium, 0};
  scene.add_quad({-1, 0, 1}, {2, 0, 0}, {0, 2, 0}, scene.add_material(front));
  return scene;
}

SceneData make_furnace_scene() {
  SceneData scene;
  const auto half = scene.add_material(make_diffuse(Color(0.5f), Color(0.5f)));
  const auto most = scene.add_material(make_diffuse(Color(0.8f), Color(0.2f)));
  const auto mirror = scene.add_material(make_metal(Color(1.0f), 0.0f));
  const auto glass = scene.add_material(make_dielectric(Color(1.0f), 1.5f));
  add_quad_box(scene, {0, 0, 0}, {4, 4, 4}, 0.0f, half, true);
  scene.add_sphere({-0.9f, -0.5f, 0}, 0.5f, most);
  scene.add_sphere({0.0f, 0.6f, -0.6f}, 0.5f, mirror);
  scene.add_sphere({0.9f, -0.5f, 0}, 0.5f, glass);
  scene.camera = {{0, 0, 1.9f}, {0, 0, 0}, {0, 1, 0}, 70.0f, 0.0f, 1.9f};
  return scene;
}

}  // namespace pt
