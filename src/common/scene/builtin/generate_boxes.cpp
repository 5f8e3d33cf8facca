#include <array>

#include "common/scene/builtin/generated_scenes.h"
#include "common/scene/builtin/shapes.h"
#include "common/scene/builtin/sphere_world.h"

namespace pt {
namespace {

constexpr int grid = 16;  ///< boxes along each side of the floor
constexpr Vec3 room_half{10, 5, 10};
constexpr Vec3 camera_position{-8.6f, 6.5f, 9.2f};

/// A box of random width and height that stands on the floor, turned about its vertical axis.
Affine standing_box(WorldRandom& random, int column, int row) {
  const Vec3 half{random.next(0.2f, 0.43f), random.next(0.1f, 0.9f), random.next(0.2f, 0.43f)};
  const float pitch = 2 * room_half.x / grid;
  const Vec3 place{(static_cast<float>(column) + 0.5f) * pitch - room_half.x, half.y,
                   (static_cast<float>(row) + 0.5f) * pitch - room_half.z};
  return translate(place) * rotate({0, 1, 0}, random.next(0, 90)) * scale(half);
}

/// A box turned in any way, in the air but not before the camera's eye.
Affine floating_box(WorldRandom& random) {
  for (;;) {
    const Vec3 place{random.next(-9, 9), random.next(2.5f, 9), random.next(-9, 9)};
    const Vec3 axis{random.next(-1, 1), random.next(-1, 1), random.next(0.1f, 1)};
    const float turn = random.next(0, 360);
    const Vec3 half{random.next(0.1f, 0.5f), random.next(0.1f, 0.5f), random.next(0.1f, 0.5f)};
    if (glm::length(place - camera_position) > 3.0f)
      return translate(place) * rotate(axis, turn) * scale(half);
  }
}

}  // namespace

SceneData make_boxes_scene(double scale_factor) {
  SceneData scene;
  const std::array<Color, 5> colors = {Color(0.75f), Color(0.7f, 0.2f, 0.15f),
                                       Color(0.2f, 0.5f, 0.25f), Color(0.2f, 0.3f, 0.65f),
                                       Color(0.7f, 0.6f, 0.3f)};
  for (const Color& color : colors) {
    scene.meshes.emplace_back();
    scene.meshes.back().material = scene.add_material(make_diffuse(color));
  }
  add_box(scene.meshes[0], translate({0, room_half.y, 0}) * scale(room_half), true);
  for (std::uint32_t i = 0; i < 2 * grid * grid; ++i) {
    WorldRandom random(i);
    const int cell = static_cast<int>(i);
    const Affine place =
        cell < grid * grid ? standing_box(random, cell % grid, cell / grid) : floating_box(random);
    add_box(scene.meshes[i % colors.size()], place);
  }
  scene.meshes.emplace_back();
  add_rectangle(scene.meshes.back(), {-2, 9.95f, -2}, {4, 0, 0}, {0, 0, 4});
  scene.meshes.back().material = scene.add_material(make_diffuse(Color(0.0f), Color(18.0f)));
  for (Mesh& mesh : scene.meshes) {
    for (Vec3& p : mesh.positions) p = Vec3(scale_factor * glm::dvec3(p));
  }
  const auto scaled = [&](const Vec3& v) { return Vec3(scale_factor * glm::dvec3(v)); };
  scene.camera = {scaled(camera_position),
                  scaled({1.5f, 2.5f, -1.5f}),
                  {0, 1, 0},
                  60.0f,
                  0.0f,
                  static_cast<float>(10 * scale_factor)};
  return scene;
}

}  // namespace pt
