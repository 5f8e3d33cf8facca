// The list of all options of `ptexp` that fill a field of Options. The command line, its help, the
// statistics, the image's header and the checks iterate it. A new option is one entry.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/options/options.h"

namespace pt {

/// How an option is given on the command line, and what it is in JSON.
enum class OptionForm {
  text,    ///< one value, a JSON string
  number,  ///< one value, a JSON number unless its text is not one (such as "auto")
  vector,  ///< three values, X Y Z or X,Y,Z
  list,    ///< one value, may be given several times; a JSON string
  flag     ///< no value, a JSON boolean
};

/// A heading of the help.
enum class OptionGroup {
  image,
  metropolis,
  stops,
  parts,
  scene,
  camera,
  execution,
  toggles,
  measurement
};

/// As the help prints it, with what is to be known of the group.
std::string heading(OptionGroup group);

/// The modes and devices in which an option, or one value of it, has an effect. An option without a
/// rule has one everywhere.
struct OptionRule {
  std::string value;  ///< empty: any; "cuda" covers "cuda:1"
  std::span<const Mode> modes;
  std::span<const DeviceChoice::Kind> devices;
  std::string instead{};  ///< what to do where it has none; empty: nothing to say
};

struct OptionEntry {
  std::string name;          ///< long name without the dashes, e.g. "max-depth"
  std::string short_flag{};  ///< e.g. "-o"; empty: none
  OptionForm form = OptionForm::text;
  std::string placeholder{};  ///< what the help shows for the value, e.g. "N"
  OptionGroup group{};
  std::string help{};  ///< lines of at most 60 characters
  /// Parses and stores a value (of a flag: ignored). Throws Error naming option and value.
  std::function<void(Options&, const std::string&)> set{};
  /// The value as `set` accepts it; empty if it is left to the scene or not given.
  std::function<std::string(const Options&)> text{};
  std::vector<OptionRule> rules{};
  bool is_expert = false;  ///< only experiments need it: --help-all lists it, --help does not
};

const std::vector<OptionEntry>& option_list();

/// An option and a value of it, as the user wrote them.
struct Setting {
  const OptionEntry* entry;
  std::string value;
};

/// Whether another value gives other samples. Renders that differ only in other options have the
/// same bits on devices of one kind, and their samples can be added.
bool determines_image(const OptionEntry& entry);

/// Whether it is about the files, repeats and parts of one render, and so has no place beside what
/// renders as often as it wants.
bool is_of_one_render(const OptionEntry& entry);

/// Throws std::logic_error when there is no such option: a programmer's mistake.
const OptionEntry& find_option(std::string_view name);

/// The name as a JSON key or CSV column: "max-depth" -> "max_depth".
std::string option_key(const OptionEntry& entry);

}  // namespace pt
