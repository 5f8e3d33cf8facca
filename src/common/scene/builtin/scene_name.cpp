#include "common/scene/builtin/scene_name.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "common/error/error.h"

namespace pt {
namespace {

/// 1, or what a suffix multiplies with; 0 for anything else.
double suffix_factor(std::string_view suffix) {
  if (suffix.empty()) return 1;
  if (suffix.size() > 1) return 0;
  switch (suffix[0]) {
    case 'k':
    case 'K':
      return 1e3;
    case 'm':
    case 'M':
      return 1e6;
    case 'g':
    case 'G':
      return 1e9;
    default:
      return 0;
  }
}

/// A number without a sign and perhaps a suffix; -1 for anything else.
double read_number(std::string_view text) {
  double value = 0;
  const bool unsigned_number =
      !text.empty() && (text[0] == '.' || (text[0] >= '0' && text[0] <= '9'));
  if (!unsigned_number) return -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) return -1;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  const double factor = suffix_factor(text);
  return factor > 0 ? value * factor : -1;
}

}  // namespace

SceneName parse_scene_name(const std::string& text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return {text, text, ""};
  if (colon + 1 == text.size()) {
    throw Error(fmt::format("--scene {}: expected a parameter after the colon", text));
  }
  return {text, text.substr(0, colon), text.substr(colon + 1)};
}

std::uint64_t parse_count(const SceneName& scene, std::uint64_t standard, std::uint64_t least,
                          std::uint64_t most) {
  if (scene.parameter.empty()) return standard;
  const double value = read_number(scene.parameter);
  // 2.5M is whole although 2.3 * 1e6 may not be so by rounding.
  const double whole = std::round(value);
  const bool is_whole = std::abs(value - whole) <= 1e-9 * whole;
  if (!(value >= 0 && is_whole && whole >= static_cast<double>(least) &&
        whole <= static_cast<double>(most))) {
    throw Error(
        fmt::format("--scene {}: expected {}:N with a whole number N from {} to {}, "
                    "such as 10K or 2.5M",
                    scene.full, scene.name, least, most));
  }
  return static_cast<std::uint64_t>(whole);
}

double parse_scale(const SceneName& scene) {
  if (scene.parameter.empty()) return 1;
  const double value = read_number(scene.parameter);
  if (!(value >= 1e-6 && value <= 1e6)) {
    throw Error(fmt::format("--scene {}: expected {}:SCALE with a factor from 1e-6 to 1e6",
                            scene.full, scene.name));
  }
  return value;
}

std::string_view next_part(std::string_view& rest) {
  const std::size_t end = std::min(rest.find(':'), rest.size());
  const std::string_view part = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return part;
}

void refuse_part(const SceneName& scene, char part, std::string_view value,
                 std::string_view expected, const char* form) {
  throw Error(fmt::format("--scene {}: {} is '{}', expected {} in {}", scene.full, part, value,
                          expected, form));
}

}  // namespace pt
