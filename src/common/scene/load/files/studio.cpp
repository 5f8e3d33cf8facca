#include "common/scene/load/files/studio.h"

#include <algorithm>
#include <cmath>

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

}  // namespace

float studio_radiance(const Vec3& direction) {
  const Vec3 key = glm::normalize(Vec3(-1.0f, 1.1f, 0.9f));
  const float facing = std::max(0.0f, glm::dot(direction, key));
  const float ground = 1.0f + (1.0f - below) * std::min(direction.y, 0.0f);
  return grey * ground + key_light * std::pow(facing, key_exponent);
}

void add_studio(SceneData& scene) {
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
      map.pixels.emplace_back(studio_radiance(direction));
    }
  }
  map.to_world = camera_axes(scene.camera);
  scene.defaults.measure_exposure = true;
}

}  // namespace pt
