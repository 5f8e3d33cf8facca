#include "view/change_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/error/error.h"
#include "common/options/option_names.h"

namespace pt {

namespace {

using Json = nlohmann::json;

const std::vector<Mode> split_modes{Mode::wavefront, Mode::megakernel};

double number(const Json& value, const std::string& key, double least, double most) {
  const double x = value.is_number() ? value.get<double>() : most + 1;
  if (!(x >= least && x <= most))
    throw Error(fmt::format("\"{}\": expected a number from {} to {}", key, least, most));
  return x;
}

[[noreturn]] void refuse_key(const std::string& key, const char* expected) {
  throw Error(fmt::format("\"{}\": no such key; expected {}", key, expected));
}

Orbit read_orbit(const Json& json) {
  if (!json.is_object())
    throw Error("\"orbit\": expected an object with \"yaw\", \"pitch\" and \"zoom\"");
  Orbit orbit;
  for (const auto& [key, value] : json.items()) {
    if (key == "yaw")
      orbit.yaw = number(value, key, -1e6, 1e6);
    else if (key == "pitch")
      orbit.pitch = number(value, key, -180, 180);
    else if (key == "zoom")
      orbit.zoom = number(value, key, 1e-3, 1e3);
    else
      refuse_key(key, "\"yaw\", \"pitch\" or \"zoom\"");
  }
  return orbit;
}

std::vector<Mode> read_mode(const Json& json) {
  const std::string name = json.is_string() ? json.get<std::string>() : "";
  if (name == "split") return split_modes;
  for (const auto& mode : enum_names<Mode>)
    if (mode.name == name) return {mode.value};
  throw Error(fmt::format("\"mode\": expected one of {}, split", joined_names<Mode>(", ")));
}

}  // namespace

SettingsChange read_change(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) throw Error("settings: expected a JSON object");
  SettingsChange change;
  for (const auto& [key, value] : json.items()) {
    if (key == "orbit")
      change.orbit = read_orbit(value);
    else if (key == "mode")
      change.modes = read_mode(value);
    else if (key == "exposure")
      change.exposure = static_cast<float>(number(value, key, -100, 100));
    else
      refuse_key(key, "\"orbit\", \"mode\" or \"exposure\"");
  }
  return change;
}

std::string mode_name(const std::vector<Mode>& modes) {
  return modes.size() > 1 ? "split" : to_string(modes.front());
}

namespace {

using Wide = glm::dvec3;

constexpr double degree = std::numbers::pi / 180;
constexpr double most_elevation = 89 * degree;

/// The vector from the point looked at to the camera, split along and across the up vector.
struct Offset {
  explicit Offset(const CameraParameters& camera)
      : axis(glm::normalize(Wide(camera.up))),
        all(Wide(camera.look_from) - Wide(camera.look_at)),
        flat(all - glm::dot(all, axis) * axis),
        elevation(std::atan2(glm::dot(all, axis), glm::length(flat))) {}

  double steepest() const { return std::max(most_elevation, std::abs(elevation)); }

  Wide axis, all, flat;
  double elevation;  ///< radians
};

}  // namespace

PitchRange pitch_range(const CameraParameters& camera) {
  const Offset offset(camera);
  return {(-offset.steepest() - offset.elevation) / degree,
          (offset.steepest() - offset.elevation) / degree};
}

CameraParameters orbit_camera(const CameraParameters& camera, const Orbit& orbit) {
  if (orbit == Orbit()) return camera;
  const Offset offset(camera);
  const Wide ahead = glm::normalize(offset.flat), aside = glm::cross(offset.axis, ahead);
  const double elevation =
      std::clamp(offset.elevation + orbit.pitch * degree, -offset.steepest(), offset.steepest());
  const double turn = (camera.mirrored ? -orbit.yaw : orbit.yaw) * degree;
  const Wide level = std::cos(turn) * ahead + std::sin(turn) * aside;
  const Wide direction = std::cos(elevation) * level + std::sin(elevation) * offset.axis;

  CameraParameters moved = camera;
  const auto zoom = static_cast<float>(orbit.zoom);
  moved.look_from = Vec3(Wide(camera.look_at) + orbit.zoom * glm::length(offset.all) * direction);
  moved.focus_distance *= zoom;
  moved.orthographic_size *= zoom;
  return moved;
}

}  // namespace pt
