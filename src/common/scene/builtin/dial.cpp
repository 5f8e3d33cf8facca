#include "common/scene/builtin/dial.h"

#include <algorithm>
#include <string_view>

#include "common/error/error.h"
#include "common/math/functions.h"
#include "common/scene/builtin/scene_name.h"
#include "common/scene/builtin/shapes.h"
#include "common/scene/builtin/sphere_world.h"
#include "common/scene/data/plastic_material.h"

namespace pt {

DialSettings parse_dial(const SceneName& scene) {
  DialSettings settings;
  if (scene.parameter.empty()) return settings;
  std::string_view rest = scene.parameter;
  const bool has_coherence = rest.find(':') != std::string_view::npos;
  const std::string_view materials = next_part(rest);
  if (!read_part(materials, 1u, dial_materials_most, settings.materials)) {
    refuse_part(scene, 'K', materials, "a whole number of materials from 1 to 32", "dial:K:C:F");
  }
  if (!has_coherence) return settings;
  const bool has_form = rest.find(':') != std::string_view::npos;
  const std::string_view coherence = next_part(rest);
  if (!read_part(coherence, 0.0f, 1.0f, settings.coherence)) {
    refuse_part(scene, 'C', coherence, "a coherence from 0 to 1", "dial:K:C:F");
  }
  if (!has_form) return settings;
  if (rest != "open" && rest != "closed")
    refuse_part(scene, 'F', rest, "open or closed", "dial:K:C:F");
  settings.closed = rest == "closed";
  return settings;
}

std::uint32_t dial_material_of(const DialSettings& settings, std::uint32_t cell,
                               std::uint32_t column, std::uint32_t columns) {
  WorldRandom random(cell);
  if (random.next() < settings.coherence) return column * settings.materials / columns;
  const float count = static_cast<float>(settings.materials);
  return std::min(static_cast<std::uint32_t>(random.next(0, count)), settings.materials - 1);
}

namespace {

/// What differs from one round of the kinds to the next.
struct Look {
  Color hue;              ///< about 1
  float roughness;        ///< of facets, in [0, 1]
  float exponent, index;  ///< of Phong's highlight; of plastics and glass
  int is_beckmann;
};

Look look_of(std::uint32_t material_index, std::uint32_t round) {
  constexpr float roughness[] = {0.15f, 0.3f, 0.1f}, exponent[] = {20, 60, 8};
  constexpr float index[] = {1.5f, 1.4f, 1.6f};
  Look look{Color(1.0f), roughness[round % 3], exponent[round % 3], index[round % 3],
            static_cast<int>(round % 2)};
  for (int c = 0; c < 3; ++c) {  // turns by the golden ratio: neighbours differ most
    const float turns =
        0.618034f * static_cast<float>(material_index) + static_cast<float>(c) / 3.0f;
    look.hue[c] += 0.12f * sincos_2pi(turns - std::floor(turns)).cos;
  }
  return look;
}

using Maker = MaterialDescription (*)(const Look&);

/// The dial's own list: a new BSDF does not join it, for the scene is a benchmark. The numbers make
/// the albedos alike.
constexpr Maker makers[] = {
    [](const Look& l) { return make_diffuse(0.75f * l.hue); },
    [](const Look& l) {
      return make_material<Conductor>(0.79f * l.hue, 0.0f, 1.0f, l.roughness, l.roughness,
                                      l.is_beckmann);
    },
    [](const Look& l) { return make_plastic(0.73f * l.hue, Color(1.0f), {l.index}); },
    [](const Look& l) {
      return make_rough_plastic(0.85f * l.hue, Color(1.0f), {l.index}, l.roughness,
                                l.is_beckmann != 0);
    },
    // Roughness, metallic, transmission, index, anisotropic, specular tint, sheen and its tint,
    // flatness, coat and its gloss.
    [](const Look& l) {
      return make_material<Principled>(0.69f * l.hue, std::sqrt(l.roughness), 0.0f, 0.0f, l.index,
                                       0.0f, 0.2f, 0.2f, 0.5f, 0.2f, 0.3f, 0.5f);
    },
    [](const Look& l) { return make_material<Phong>(0.5f * l.hue, Color(0.37f), l.exponent); },
    [](const Look& l) {
      return make_material<Ward>(0.45f * l.hue, Color(0.33f), l.roughness, l.roughness);
    },
    [](const Look& l) { return make_material<OrenNayar>(0.78f * l.hue, l.roughness); },
    [](const Look& l) { return make_metal(0.76f * l.hue, l.roughness); },
    // Roughness, transmission, index, anisotropic, specular tint, sheen and its tint, flatness.
    [](const Look& l) {
      return make_material<PrincipledThin>(0.75f * l.hue, std::sqrt(l.roughness), 0.0f, l.index,
                                           0.0f, 0.2f, 0.1f, 0.5f, 0.2f, 0.0f);
    },
    [](const Look& l) { return make_material<ThinDielectric>(Color(1.0f), Color(1.0f), l.index); },
    [](const Look& l) { return make_dielectric(Color(1.0f), l.index - 0.3f); },
    [](const Look& l) {
      return make_material<RoughDielectric>(Color(1.0f), Color(1.0f), l.index - 0.3f, l.roughness,
                                            l.roughness, l.is_beckmann);
    },
};
static_assert(std::size(makers) == dial_kinds);

}  // namespace

MaterialDescription make_dial_material(std::uint32_t index) {
  return makers[index % dial_kinds](look_of(index, index / dial_kinds));
}

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
