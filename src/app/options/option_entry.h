// Makes the entries of option_list.h: one function for each kind of field of Options. Every one
// returns an entry that lacks its group and help only.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "app/options/option_list.h"
#include "app/options/option_values.h"

namespace pt::option_entry {

using Set = decltype(OptionEntry::set);
using Text = decltype(OptionEntry::text);

OptionEntry integer(std::string name, int Options::*field, std::uint64_t lowest,
                    std::uint64_t highest);
OptionEntry text(std::string name, std::string placeholder, std::string Options::*field);
OptionEntry vector(std::string name, std::optional<std::array<float, 3>> CameraOverrides::*field);
/// `expected` and `holds` as in parse_number.
OptionEntry number(std::string name, std::string placeholder,
                   std::optional<float> CameraOverrides::*field, const char* expected,
                   bool (*holds)(float));
/// 0 is what it is where it is not given.
OptionEntry number(std::string name, std::string placeholder, float Options::*field,
                   const char* expected, bool (*holds)(float));
OptionEntry custom(std::string name, OptionForm form, std::string placeholder, Set set,
                   Text get_text);

/// `Settings`: Options, or the part of them that has the field.
template <typename E, typename Settings>
OptionEntry choice(std::string name, E Settings::*field) {
  OptionEntry entry{.name = name, .placeholder = joined_names<E>("|")};
  entry.set = [=](Options& options, const std::string& text) {
    options.*field = parse_name<E>(name, text);
  };
  entry.text = [=](const Options& options) { return to_string(options.*field); };
  return entry;
}

}  // namespace pt::option_entry
