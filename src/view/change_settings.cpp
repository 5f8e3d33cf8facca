#include "view/change_settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
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
      throw Error(fmt::format("\"{}\": no such key; expected \"yaw\", \"pitch\" or \"zoom\"", key));
  }
  return orbit;
}

std::string text_of(const Json& json) { return json.is_string() ? json.get<std::string>() : ""; }

std::vector<Mode> read_mode(const Json& json) {
  const std::string name = text_of(json);
  if (name == "split") return split_modes;
  for (const auto& mode : enum_names<Mode>)
    if (mode.name == name) return {mode.value};
  throw Error(fmt::format("\"mode\": expected one of {}, split", joined_names<Mode>(", ")));
}

ToneCurve read_curve(const Json& json) {
  for (const auto& curve : enum_names<ToneCurve>)
    if (curve.name == text_of(json)) return curve.value;
  throw Error(fmt::format("\"curve\": expected one of {}", joined_names<ToneCurve>(", ")));
}

std::string read_layer(const Json& json) {
  std::string name = text_of(json);
  if (layer_bit(name)) return name;
  throw Error(fmt::format("\"layer\": expected one of {}", fmt::join(layer_names(), ", ")));
}

bool read_flag(const Json& json, const std::string& key) {
  if (!json.is_boolean()) throw Error(fmt::format("\"{}\": expected true or false", key));
  return json.get<bool>();
}

int whole_number(const Json& json, const std::string& key, int most) {
  if (!json.is_number_integer() || json < 1 || json > most)
    throw Error(fmt::format("\"{}\": expected a whole number from 1 to {}", key, most));
  return json.get<int>();
}

ImageSize read_size(const Json& json) {
  if (!json.is_array() || json.size() != 2)
    throw Error("\"size\": expected width and height, such as [640, 480]");
  return {whole_number(json[0], "size", image_side_max),
          whole_number(json[1], "size", image_side_max)};
}

ParameterValues read_parameters(const Json& json) {
  if (!json.is_object())
    throw Error("\"parameters\": expected an object of names and values, or null");
  ParameterValues values;
  for (const auto& [name, value] : json.items()) {
    const Json list = value.is_array() ? value : Json::array({value});
    for (const Json& one : list) {
      constexpr double most = std::numeric_limits<float>::max();
      if (!one.is_number() || !(std::abs(one.get<double>()) <= most))
        throw Error(fmt::format("\"parameters\": \"{}\": expected numbers", name));
      values[name].push_back(one.get<float>());
    }
  }
  return values;
}

/// A key of the JSON, and how its value is read.
struct Key {
  std::string_view name;
  void (*read)(const Json& value, const std::string& key, SettingsChange& change);
};
using Text = const std::string&;

constexpr Key keys[] = {
    {"orbit", [](const Json& v, Text, SettingsChange& c) { c.orbit = read_orbit(v); }},
    {"mode", [](const Json& v, Text, SettingsChange& c) { c.modes = read_mode(v); }},
    {"size", [](const Json& v, Text, SettingsChange& c) { c.size = read_size(v); }},
    {"scale", [](const Json& v, Text key,
                 SettingsChange& c) { c.scale = number(v, key, scale_min, scale_max); }},
    {"spp",
     [](const Json& v, Text key, SettingsChange& c) {
       c.spp = whole_number(v, key, std::numeric_limits<int>::max());
     }},
    {"paused", [](const Json& v, Text key, SettingsChange& c) { c.is_paused = read_flag(v, key); }},
    {"layer", [](const Json& v, Text, SettingsChange& c) { c.layer = read_layer(v); }},
    {"exposure",
     [](const Json& v, Text key, SettingsChange& c) {
       c.exposure = static_cast<float>(number(v, key, -100, 100));
     }},
    {"curve", [](const Json& v, Text, SettingsChange& c) { c.curve = read_curve(v); }},
    {"time",
     [](const Json& v, Text key, SettingsChange& c) {
       c.time.emplace();
       if (!v.is_null()) c.time->emplace(static_cast<float>(number(v, key, -1e9, 1e9)));
     }},
    {"parameters", [](const Json& v, Text, SettingsChange& c) {
       c.resets_parameters = v.is_null();
       if (!v.is_null()) c.parameters = read_parameters(v);
     }}};

}  // namespace

SettingsChange read_change(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) throw Error("settings: expected a JSON object");
  SettingsChange change;
  for (const auto& [name, value] : json.items()) {
    const auto key = std::ranges::find(keys, name, &Key::name);
    if (key == std::end(keys)) {
      std::string names;
      for (const Key& one : keys)
        names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", one.name);
      throw Error(fmt::format("\"{}\": no such key; expected one of {}", name, names));
    }
    key->read(value, name, change);
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
  if (camera.aperture > 0) moved.focus_distance *= zoom;  // else the options cannot say it
  moved.orthographic_size *= zoom;
  return moved;
}

ImageSize scaled(const ImageSize& size, double scale) {
  const auto side = [&](int pixels) {
    return static_cast<int>(std::clamp(std::round(pixels * scale), 1.0, double{image_side_max}));
  };
  return {side(size.width), side(size.height)};
}

namespace {

std::string text_of(const Vec3& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

}  // namespace

std::string camera_options(const CameraParameters& camera) {
  std::string text = fmt::format("--look-from {} --look-at {} --up {}", text_of(camera.look_from),
                                 text_of(camera.look_at), text_of(camera.up));
  // The option is of the vertical angle; along another axis the scene has it.
  if (!camera.orthographic && camera.fov_axis == FovAxis::vertical)
    text += fmt::format(" --fov {}", camera.fov_degrees);
  if (!camera.orthographic && camera.aperture > 0)
    text +=
        fmt::format(" --aperture {} --focus-distance {}", camera.aperture, camera.focus_distance);
  return text;
}

std::string camera_xml(const CameraParameters& camera, const ImageSize& size) {
  const bool has_lens = !camera.orthographic && camera.aperture > 0;
  std::string text = fmt::format("<sensor type=\"{}\">\n", camera.orthographic ? "orthographic"
                                                           : has_lens          ? "thinlens"
                                                                               : "perspective");
  const auto add = [&](const char* kind, const char* name, auto value) {
    text += fmt::format("  <{} name=\"{}\" value=\"{}\"/>\n", kind, name, value);
  };
  constexpr const char* axes[] = {"y", "x", "diagonal", "smaller", "larger"};  // as FovAxis
  if (!camera.orthographic) {
    add("float", "fov", camera.fov_degrees);
    add("string", "fov_axis", axes[static_cast<int>(camera.fov_axis)]);
  }
  if (has_lens) {
    add("float", "aperture_radius", camera.aperture / 2);
    add("float", "focus_distance", camera.focus_distance);
  }
  // Mitsuba's own planes, 0.01 and 10,000, might cut the scene.
  add("float", "near_clip", std::max(camera.near_clip, 1e-4f));
  add("float", "far_clip", std::min(camera.far_clip, 1e8f));
  if (camera.principal_point.x != 0 || camera.principal_point.y != 0) {
    add("float", "principal_point_offset_x", camera.principal_point.x);
    add("float", "principal_point_offset_y", camera.principal_point.y);
  }
  text += "  <transform name=\"to_world\">\n";
  const Vec2 scale = camera.orthographic ? camera.orthographic_size : Vec2(1.0f);
  if (camera.mirrored || camera.orthographic) {
    text += fmt::format("    <scale x=\"{}\" y=\"{}\"/>\n", camera.mirrored ? -scale.x : scale.x,
                        scale.y);
  }
  text += fmt::format("    <lookat origin=\"{}\" target=\"{}\" up=\"{}\"/>\n  </transform>\n",
                      text_of(camera.look_from), text_of(camera.look_at), text_of(camera.up));
  return text + fmt::format(
                    "  <film type=\"hdrfilm\">\n"
                    "    <integer name=\"width\" value=\"{}\"/>\n"
                    "    <integer name=\"height\" value=\"{}\"/>\n"
                    "  </film>\n</sensor>\n",
                    size.width, size.height);
}

}  // namespace pt
