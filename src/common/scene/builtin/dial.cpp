#include "common/scene/builtin/dial.h"

#include "common/scene/builtin/dial_materials.h"
#include "common/scene/builtin/shapes.h"

namespace pt {
namespace {

constexpr float gap = 0.25f;  ///< between the cells and what is behind them

/// A wall: `cells` times `cells` cells from `corner` along a and b, facing cross(a, b).
struct Wall {
  Vec3 corner, a, b;
};

void add_cells(SceneData& scene, const DialSettings& settings, const Wall& wall,
               std::uint32_t first_cell, std::uint32_t cells) {
  for (std::uint32_t row = 0; row < cells; ++row) {
    for (std::uint32_t column = 0; column < cells; ++column) {
      const std::uint32_t cell = first_cell + row * cells + column;
      const Vec3 corner = wall.corner + static_cast<float>(column) * wall.a +
                          static_cast<float>(row) * wall.b;  // whole numbers: exact
      const std::uint32_t material = dial_material_of(settings, cell, column, cells);
      add_rectangle(scene.meshes[material], corner, wall.a, wall.b);
    }
  }
}

void add_floor(SceneData& scene, const DialSettings& settings) {
  constexpr float half = dial_floor_cells / 2;
  add_cells(scene, settings, {{-half, 0, half}, {1, 0, 0}, {0, 0, -1}}, 0, dial_floor_cells);
  scene.meshes.emplace_back();
  add_rectangle(scene.meshes.back(), {-half, -gap, half}, {2 * half, 0, 0}, {0, 0, -2 * half});
  scene.sky = {Color(1.0f), {0.5f, 0.7f, 1.0f}};
  scene.camera = {{0, 130, 60}, {0, 0, 3}, {0, 1, 0}, 44.0f, 0.0f, 140.0f};
}

void add_room(SceneData& scene, const DialSettings& settings) {
  constexpr float half = dial_wall_cells / 2, side = dial_wall_cells;
  const Wall walls[] = {{{-half, 0, half}, {1, 0, 0}, {0, 0, -1}},     // floor
                        {{-half, side, -half}, {1, 0, 0}, {0, 0, 1}},  // ceiling
                        {{-half, 0, -half}, {1, 0, 0}, {0, 1, 0}},     // back
                        {{half, 0, half}, {-1, 0, 0}, {0, 1, 0}},      // front
                        {{-half, 0, half}, {0, 0, -1}, {0, 1, 0}},     // left
                        {{half, 0, -half}, {0, 0, 1}, {0, 1, 0}}};     // right
  std::uint32_t cell = 0;
  for (const Wall& wall : walls) {
    add_cells(scene, settings, wall, cell, dial_wall_cells);
    cell += dial_wall_cells * dial_wall_cells;
  }
  scene.meshes.emplace_back();
  add_box(scene.meshes.back(), translate({0, half, 0}) * scale(Vec3(half + gap)), true);
  scene.meshes.emplace_back();
  add_rectangle(scene.meshes.back(), {-8, side - 1, -8}, {16, 0, 0}, {0, 0, 16});
  scene.meshes.back().material = scene.add_material(make_diffuse(Color(0.0f), Color(12.0f)));
  scene.camera = {{-28, 40, 28}, {6, 26, -6}, {0, 1, 0}, 60.0f, 0.0f, 60.0f};
}

}  // namespace

SceneData make_dial_scene(const DialSettings& settings) {
  SceneData scene;
  for (std::uint32_t i = 0; i < settings.materials; ++i) {
    scene.meshes.emplace_back();
    scene.meshes.back().material = scene.add_material(make_dial_material(i));
  }
  settings.closed ? add_room(scene, settings) : add_floor(scene, settings);
  return scene;
}

}  // namespace pt
