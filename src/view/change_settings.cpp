#include "view/change_settings.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

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

}  // namespace pt
