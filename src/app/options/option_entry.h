// Makes the entries of option_list.cpp: a function for each kind of field of Options. Group and
// help are added there.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "app/options/option_list.h"
#include "app/options/option_values.h"

namespace pt::option_entry {

/// `field`: a member of Options, or a function from Options to a reference. `parse(name, text)`
/// returns its value, `print(value)` the text.
template <typename Field, typename Parse, typename Print>
OptionEntry value(std::string name, OptionForm form, std::string placeholder, Field field,
                  Parse parse, Print print) {
  OptionEntry entry{.name = name, .form = form, .placeholder = std::move(placeholder)};
  entry.set = [=](Options& options, const std::string& text) {
    std::invoke(field, options) = parse(name, text);
  };
  entry.text = [=](const Options& options) { return print(std::invoke(field, options)); };
  return entry;
}

template <typename T>
auto in_camera(T CameraOverrides::*field) {
  return [field](auto& options) -> auto& { return options.camera.*field; };
}

inline OptionEntry integer(std::string name, int Options::*field, std::uint64_t lowest,
                           std::uint64_t highest) {
  return value(
      std::move(name), OptionForm::number, "N", field,
      [=](const std::string& n, const std::string& text) {
        return static_cast<int>(parse_integer(n, text, lowest, highest));
      },
      [](int x) { return std::to_string(x); });
}

inline OptionEntry text(std::string name, std::string placeholder, std::string Options::*field) {
  const auto parse = [](const std::string& n, const std::string& text) {
    // `--stats --quiet`: the file's name is missing.
    if (text.empty() || text.starts_with("--")) refuse_value(n, text, "expected a name");
    return text;
  };
  return value(std::move(name), OptionForm::text, std::move(placeholder), field, parse,
               [](const std::string& x) { return x; });
}

inline OptionEntry vector(std::string name,
                          std::optional<std::array<float, 3>> CameraOverrides::*field) {
  return value(std::move(name), OptionForm::vector, "X Y Z", in_camera(field), parse_vector,
               [](const auto& x) { return x ? vector_text(*x) : ""; });
}

/// `expected` and `holds` as in parse_number.
inline OptionEntry number(std::string name, std::string placeholder,
                          std::optional<float> CameraOverrides::*field, const char* expected,
                          bool (*holds)(float)) {
  return value(
      std::move(name), OptionForm::number, std::move(placeholder), in_camera(field),
      [=](const std::string& n, const std::string& s) {
        return parse_number(n, s, expected, holds);
      },
      [](const std::optional<float>& x) { return x ? number_text(*x) : ""; });
}

/// 0 stands for an option that is not given.
inline OptionEntry number(std::string name, std::string placeholder, float Options::*field,
                          const char* expected, bool (*holds)(float)) {
  return value(
      std::move(name), OptionForm::number, std::move(placeholder), field,
      [=](const std::string& n, const std::string& s) {
        return parse_number(n, s, expected, holds);
      },
      [](float x) { return x == 0.0f ? "" : number_text(x); });
}

/// 0 stands for auto; `what` the number counts.
inline OptionEntry size_or_auto(std::string name, std::uint64_t Options::*field,
                                const std::string& what, std::uint64_t most) {
  return value(
      std::move(name), OptionForm::number, "N|auto", field,
      [=](const std::string& n, const std::string& s) {
        return s == "auto" ? 0 : parse_size(n, s, "auto or a number of " + what, most);
      },
      [](std::uint64_t x) { return x == 0 ? "auto" : std::to_string(x); });
}

inline std::string switch_text(bool is_on) { return is_on ? "on" : "off"; }

inline OptionEntry on_off(std::string name, bool Options::*field) {
  return value(std::move(name), OptionForm::text, "on|off", field, parse_switch, switch_text);
}

inline OptionEntry flag(std::string name, bool Options::*field) {
  return value(
      std::move(name), OptionForm::flag, "", field,
      [](const std::string&, const std::string&) { return true; }, switch_text);
}

template <typename E, typename Settings>
OptionEntry choice(std::string name, E Settings::*field) {
  return value(std::move(name), OptionForm::text, joined_names<E>("|"), field, parse_name<E>,
               [](E x) { return to_string(x); });
}

}  // namespace pt::option_entry
