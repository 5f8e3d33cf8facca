#include "common/scene/builtin/quad_scenes.h"

#include "common/math/functions.h"
#include "common/scene/builtin/shapes.h"

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

namespace {

constexpr float half_width = 2.0f, room_height = 2.6f, front = 4.0f, back = -3.0f;
constexpr float door_degrees = 2.0f, door_thickness = 0.04f;

/// Two rooms that share floor, ceiling and side walls, and the wall between them.
void add_rooms(SceneData& scene) {
  const auto white = scene.add_material(make_diffuse(Color(0.75f)));
  const auto floor = scene.add_material(make_diffuse({0.5f, 0.36f, 0.24f}));
  const auto left = scene.add_material(make_diffuse({0.3f, 0.45f, 0.6f}));
  constexpr float w = 2 * half_width, h = room_height, depth = front - back;
  scene.add_quad({-half_width, 0, back}, {0, 0, depth}, {w, 0, 0}, floor);
  scene.add_quad({-half_width, h, back}, {w, 0, 0}, {0, 0, depth}, white);  // ceiling
  scene.add_quad({-half_width, 0, back}, {w, 0, 0}, {0, h, 0}, white);      // back wall
  scene.add_quad({-half_width, 0, front}, {0, h, 0}, {w, 0, 0}, white);     // behind the camera
  scene.add_quad({-half_width, 0, back}, {0, h, 0}, {0, 0, depth}, left);   // left walls
  scene.add_quad({half_width, 0, back}, {0, 0, depth}, {0, h, 0}, white);   // right walls
  constexpr float beside = AjarDoorway::left + half_width, above = h - AjarDoorway::height;
  scene.add_quad({-half_width, 0, 0}, {beside, 0, 0}, {0, h, 0}, white);
  scene.add_quad({AjarDoorway::right, 0, 0}, {half_width - AjarDoorway::right, 0, 0}, {0, h, 0},
                 white);
  scene.add_quad({AjarDoorway::left, AjarDoorway::height, 0},
                 {AjarDoorway::right - AjarDoorway::left, 0, 0}, {0, above, 0}, white);
}

/// Hangs at the left side of the doorway and opens into the back room.
void add_door(SceneData& scene) {
  const auto wood = scene.add_material(make_diffuse({0.6f, 0.42f, 0.22f}));
  constexpr float width = AjarDoorway::right - AjarDoorway::left, height = AjarDoorway::height;
  const SinCos turn = sincos_2pi(door_degrees / 360.0f);
  const Vec3 along{turn.cos, 0, -turn.sin}, inward{-turn.sin, 0, -turn.cos};
  const Vec3 hinge{AjarDoorway::left, 0.5f * height, 0};
  add_quad_box(scene, hinge + 0.5f * width * along + 0.5f * door_thickness * inward,
               {width, height, door_thickness}, door_degrees, wood);
}

void add_lamp_stand(SceneData& scene) {
  const auto dark = scene.add_material(make_diffuse(Color(0.1f)));
  const auto lamp = scene.add_material(make_diffuse(Color(0.0f), {28800.0f, 25200.0f, 19800.0f}));
  constexpr float x = 1.1f, z = -1.2f, half = 0.2f, top = AjarDoorway::lamp_height;
  scene.add_quad({x - half, top, z - half}, {0, 0, 2 * half}, {2 * half, 0, 0}, lamp);
  add_quad_box(scene, {x, top - 0.03f, z}, {2 * half, 0.05f, 2 * half}, 0.0f, dark);
  add_quad_box(scene, {x, 0.5f * top - 0.03f, z}, {0.05f, top - 0.06f, 0.05f}, 0.0f, dark);
}

void add_table(SceneData& scene) {
  const auto wood = scene.add_material(make_diffuse({0.35f, 0.22f, 0.13f}));
  const Vec3 middle{-0.75f, 0.7f, 1.5f};
  add_quad_box(scene, middle, {1.3f, 0.05f, 0.8f}, 0.0f, wood);
  for (const float x : {-0.6f, 0.6f}) {
    for (const float z : {-0.35f, 0.35f})
      add_quad_box(scene, middle + Vec3(x, -0.3625f, z), {0.06f, 0.675f, 0.06f}, 0.0f, wood);
  }
  const Vec3 top = middle + Vec3(0, 0.025f, 0);
  const auto add_ball = [&](float x, float z, float radius, const MaterialDescription& material) {
    scene.add_sphere(top + Vec3(x, radius, z), radius, scene.add_material(material));
  };
  add_ball(-0.42f, 0.0f, 0.2f, make_diffuse({0.7f, 0.25f, 0.2f}));
  add_ball(0.0f, -0.1f, 0.2f, make_metal({0.9f, 0.75f, 0.45f}, 0.2f));
  add_ball(0.4f, 0.1f, 0.2f, make_dielectric(Color(1.0f), 1.5f));
}

/// Mirrors side by side on a circle around the y axis at `center`, seen from both sides.
void add_ring(SceneData& scene, const Vec3& center, float radius, float height,
              std::uint32_t material) {
  constexpr int sides = 360;  // a step turns the reflection by less than the lamp's width
  const auto point = [&](int i) {
    const SinCos turn = sincos_2pi(static_cast<float>(i % sides) / static_cast<float>(sides));
    return center + radius * Vec3(turn.sin, 0, turn.cos);
  };
  for (int i = 0; i < sides; ++i)
    scene.add_quad(point(i), point(i + 1) - point(i), {0, height, 0}, material);
}

}  // namespace

SceneData make_ajar_scene() {
  SceneData scene;
  add_rooms(scene);
  add_door(scene);
  add_lamp_stand(scene);
  add_table(scene);
  scene.camera = {{1.3f, 1.5f, 3.7f}, {-0.45f, 0.85f, 0.8f}, {0, 1, 0}, 50.0f, 0.0f, 3.0f};
  scene.defaults.max_depth = 12;
  return scene;
}

SceneData make_caustic_scene() {
  SceneData scene;
  const auto floor = scene.add_material(make_diffuse({0.6f, 0.55f, 0.5f}));
  const auto lamp = scene.add_material(make_diffuse(Color(0.0f), Color(4000.0f)));
  const auto glass = scene.add_material(make_dielectric(Color(1.0f), 1.5f));
  const auto gold = scene.add_material(make_metal({0.95f, 0.8f, 0.5f}, 0.0f));
  scene.add_quad({-6, 0, -6}, {0, 0, 12}, {12, 0, 0}, floor);
  scene.add_quad({2.14f, 2.6f, -1.56f}, {0.12f, 0, 0}, {0, 0, 0.12f}, lamp);  // faces down
  scene.add_sphere({0.75f, 0.7f, 0}, 0.5f, glass);
  add_ring(scene, {-1.0f, 0, 0.6f}, 0.6f, 0.3f, gold);
  scene.camera = {{-0.4f, 3.4f, 3.6f}, {-0.25f, 0.2f, 0.4f}, {0, 1, 0}, 40.0f, 0.0f, 4.5f};
  scene.defaults.max_depth = 10;
  return scene;
}

}  // namespace pt
