// The parts of a scene's parameter, as in dial:16:0.5:closed.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "common/error/error.h"
#include "common/scene/builtin/scene_name.h"

namespace pt {

/// The part up to the next colon, which is taken away with it.
inline std::string_view next_part(std::string_view& rest) {
  const std::size_t end = std::min(rest.find(':'), rest.size());
  const std::string_view part = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return part;
}

/// A number in [least, most]; false for anything else.
template <class Number>
bool read_part(std::string_view text, Number least, Number most, Number& value) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && stop == end && value >= least && value <= most;
}

/// Throws Error: `part` of a name such as `form` is not what was expected.
[[noreturn]] inline void refuse_part(const SceneName& scene, char part, std::string_view value,
                                     std::string_view expected, const char* form) {
  throw Error(fmt::format("--scene {}: {} is '{}', expected {} in {}", scene.full, part, value,
                          expected, form));
}

}  // namespace pt
