// What a user calls a scene: a name, and for generated scenes a parameter, as in terrain:10M.
#pragma once

#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>

namespace pt {

struct SceneName {
  std::string full;  ///< as given, for messages
  std::string name;
  std::string parameter;  ///< empty: none was given
};

/// Splits at the first colon. Throws Error for a colon with nothing after it.
SceneName parse_scene_name(const std::string& text);

/// The parameter as a whole number from `least` to `most`: digits, then perhaps K, M or G for
/// thousands, millions or thousand millions (decimal), with a fraction as in 2.5M. `standard` where
/// no parameter was given. Throws Error.
std::uint64_t parse_count(const SceneName& scene, std::uint64_t standard, std::uint64_t least,
                          std::uint64_t most);

/// The parameter as a positive factor, as in boxes:1e-3; 1 where none was given. Throws Error for
/// one outside [1e-6, 1e6].
double parse_scale(const SceneName& scene);

// The parts of a parameter, as in dial:16:0.5:closed.

/// The part up to the next colon, which is taken away with it.
std::string_view next_part(std::string_view& rest);

/// A number in [least, most]; false for anything else.
template <class Number>
bool read_part(std::string_view text, Number least, Number most, Number& value) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && stop == end && value >= least && value <= most;
}

/// Throws Error: `part` of a name such as `form` is not what was expected.
[[noreturn]] void refuse_part(const SceneName& scene, char part, std::string_view value,
                              std::string_view expected, const char* form);

}  // namespace pt
