#include "common/scene/load/files/default_lighting.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/image/tone_mapping.h"
#include "common/light/light.h"
#include "common/scene/data/scene_data.h"
#include "common/scene/prepare/prepare_steps.h"

namespace pt {
namespace {

constexpr int map_height = 128;
constexpr float grey = 0.2f;       // towards the horizon and above
constexpr float below = 0.5f;      // of it, straight below
constexpr float key_light = 2.5f;  // above the grey, in its middle
constexpr float key_exponent = 4;  // half of it at 33 degrees

/// The camera's view and up direction as axes; the identity where they give none.
Affine camera_axes(const CameraParameters& camera) {
  const Vec3 backward = camera.look_from - camera.look_at;
  const Vec3 side = glm::cross(camera.up, backward);
  if (!(glm::length(side) > 0.0f) || !std::isfinite(glm::length(side))) return {};
  const Vec3 x = normalize(side), z = normalize(backward), y = glm::cross(z, x);
  Affine axes;
  for (int i = 0; i < 3; ++i) axes.row[i] = {x[i], y[i], z[i], 0.0f};
  return axes;
}

// By emission alone: at exposure 0 a white surface of less is black (3 of 255 in sRGB), and one
// with so little of the mean is outside of what a small lamp lights.
constexpr LitRule by_emission{1e-3f, 0.2f};
constexpr float weakest_emitter = 0.01f;  // what is less is no lamp
/// Lights of a file are meant to light it, and a PNG's exposure is measured.
constexpr LitRule by_lights{1e-6f, 0.0f};
constexpr double lit_by_emission = 0.5, lit_by_lights = 0.02;
/// For a camera that was guessed, and for the best one along an axis.
constexpr double lit_as_framed = 0.2, lit_along_axis = 0.7;
constexpr float tolerated_stops = 2.0f;

float brightest(const Color& c) { return std::max({c.x, c.y, c.z}); }

/// Whether a material may light surfaces: it emits `least` or more, and no texture of it is black.
std::vector<bool> lamps_among(const SceneData& scene, float least) {
  std::vector<bool> lamps;
  for (const MaterialDescription& material : scene.materials) {
    const Emission& emission = material.emission;
    if (!(brightest(emission.radiance) >= least)) {
      lamps.push_back(false);
      continue;
    }
    const auto is_there = [&](std::uint32_t texture) {
      return texture == no_texture ||
             mean_luminance(scene.textures.data(), texture, scene.texels.data()) > 0;
    };
    const Opacity& opacity = material.opacity;
    const bool is_seen =
        opacity.texture == no_texture ? opacity.offset > 0.0f : is_there(opacity.texture);
    lamps.push_back(is_there(emission.texture) && is_seen);
  }
  return lamps;
}

bool has_lamp(const SceneData& scene, float least) {
  const std::vector<bool> lamps = lamps_among(scene, least);
  const auto is_lamp = [&](std::uint32_t material) { return bool{lamps[material]}; };
  return std::ranges::any_of(scene.meshes, is_lamp, &Mesh::material) ||
         std::ranges::any_of(scene.sphere_material, is_lamp) ||
         std::ranges::any_of(scene.quad_material, is_lamp);
}

/// Whether an environment, a sky or a sun gives light.
bool has_far_light(const SceneData& scene) {
  return !is_black(scene.sky.nadir) || !is_black(scene.sky.zenith) ||
         (scene.sun.one_minus_cos > 0.0f && !is_black(scene.sun.radiance)) ||
         std::ranges::any_of(scene.environment.pixels, [](const Color& c) { return !is_black(c); });
}

/// Whether a white surface in the middle of the scene could be seen by a light of the file.
bool has_bright_light(const SceneData& scene, float least) {
  const Bounds bounds = scene_bounds(scene);
  const float radius = bounds.is_empty() ? 1.0f : 0.5f * glm::length(bounds.max - bounds.min);
  return std::ranges::any_of(scene.delta_lights, [&](const DeltaLight& light) {
    const float distance =
        light.kind == LightKind::directional
            ? 1.0f
            : std::max(glm::length(light.position - bounds.center()), 0.5f * radius);
    return brightest(light.intensity) / (pi * distance * distance) >= least;
  });
}

double best_along_axes(LightEstimate& estimate, const CameraParameters& framed) {
  const float distance = glm::length(framed.look_from - framed.look_at);
  double best = 0;
  for (int axis = 0; axis < 6; ++axis) {
    Vec3 direction(0.0f);
    direction[axis / 2] = axis % 2 == 0 ? distance : -distance;
    CameraParameters camera = framed;
    camera.look_from = camera.look_at + direction;
    if (axis / 2 == 1) camera.up = {0, 0, 1};
    best = std::max(best, estimate.look(camera, by_emission).lit_share);
  }
  return best;
}

/// Whether its own lights show what is seen of a scene. Sets its default exposure where they do,
/// but are much too bright or dark for a display.
bool shows(LightEstimate& estimate, const CameraOverrides& overrides, bool is_framed,
           SceneData& scene) {
  const bool has_lights = has_bright_light(scene, by_lights.least);
  const LitRule& rule = has_lights ? by_lights : by_emission;
  const double needed = has_lights ? lit_by_lights : lit_by_emission;
  CameraParameters chosen = scene.camera;
  override_camera(chosen, overrides);
  const bool is_other =
      overrides.look_from || overrides.look_at || overrides.up || overrides.vertical_fov_degrees;
  const Glimpse own = estimate.look(scene.camera, rule);
  const Glimpse seen = is_other ? estimate.look(chosen, rule) : own;
  const bool lit = own.lit_share >= needed || seen.lit_share >= needed ||
                   (is_framed && !has_lights && own.lit_share >= lit_as_framed &&
                    best_along_axes(estimate, scene.camera) >= lit_along_axis);
  if (lit && !has_lights && !seen.is_luminous)
    scene.defaults.measure_exposure |= std::abs(measure_exposure(seen.picture)) > tolerated_stops;
  return lit;
}

/// The same. A scene that cannot be rendered is left to the render, which says why.
bool is_lit(const CameraOverrides& overrides, bool is_framed, SceneData& scene) {
  std::optional<LightEstimate> estimate;
  try {
    estimate.emplace(scene);
  } catch (const Error&) {
    return true;
  }
  return shows(*estimate, overrides, is_framed, scene);
}

/// What the file has that does not light it.
std::string dark_text(const SceneData& scene) {
  std::string what = scene.delta_lights.empty() ? "" : "lights";
  if (std::ranges::any_of(scene.materials, [](const MaterialDescription& material) {
        return !is_black(material.emission.radiance);
      }))
    what += what.empty() ? "emission" : " and emission";
  if (what.empty()) return fmt::format("no light: {} is used", default_lighting_text);
  return fmt::format("the file's {} {} little or nothing of what is seen: {} is added", what,
                     scene.delta_lights.empty() ? "lights" : "light", default_lighting_text);
}

}  // namespace

float default_radiance(const Vec3& direction) {
  const Vec3 key = glm::normalize(Vec3(-1.0f, 1.1f, 0.9f));
  const float facing = std::max(0.0f, glm::dot(direction, key));
  const float ground = 1.0f + (1.0f - below) * std::min(direction.y, 0.0f);
  return grey * ground + key_light * std::pow(facing, key_exponent);
}

void add_default_lighting(SceneData& scene) {
  EnvironmentData& map = scene.environment;
  map.width = 2 * map_height;
  map.height = map_height;
  map.pixels.clear();
  map.pixels.reserve(static_cast<std::size_t>(map.width) * map_height);
  for (int row = 0; row < map.height; ++row) {
    const float from_zenith = pi * (static_cast<float>(row) + 0.5f) / map_height;
    for (int column = 0; column < map.width; ++column) {
      const float azimuth = pi * ((static_cast<float>(column) + 0.5f) / map_height - 1.0f);
      const Vec3 direction(std::sin(from_zenith) * std::sin(azimuth), std::cos(from_zenith),
                           -std::sin(from_zenith) * std::cos(azimuth));
      map.pixels.emplace_back(default_radiance(direction));
    }
  }
  map.to_world = camera_axes(scene.camera);
  scene.defaults.measure_exposure = true;
}

std::string light_model(const LoadOptions& options, bool is_framed, SceneData& scene) {
  if (options.default_lighting != DefaultLighting::automatic) return light_scene(options, scene);
  if (has_far_light(scene)) return "";
  const bool may_be_lit =
      has_lamp(scene, weakest_emitter) || has_bright_light(scene, by_lights.least);
  if (may_be_lit && is_lit(options.camera, is_framed, scene)) return "";
  const std::string text = dark_text(scene);
  add_default_lighting(scene);
  return text;
}

std::string light_scene(const LoadOptions& options, SceneData& scene) {
  const bool wanted = options.default_lighting == DefaultLighting::on;
  if (wanted && scene.environment.width > 0)
    return "--default-lighting on: the scene has an environment, which is used instead";
  if (wanted) add_default_lighting(scene);
  constexpr float any = std::numeric_limits<float>::min();
  const bool glows = std::ranges::any_of(
      scene.media, [](const Medium& medium) { return !is_black(medium.emission); });
  const bool lit =
      glows || has_far_light(scene) || has_lamp(scene, any) || has_bright_light(scene, any);
  if (wanted || lit) return "";
  return "nothing lights the picture: its lights give none; --default-lighting on adds one";
}

}  // namespace pt
