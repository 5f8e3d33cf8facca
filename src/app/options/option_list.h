// Every option of `ptexp` that fills a field of Options, in one list: the command line, its help,
// the statistics, the image metadata and the check of what applies all iterate it. A new option is
// one entry; scene_options.h has the few rules that depend on the scene.
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

/// Where an option, or one value of it, has an effect. What has no rule applies everywhere.
struct OptionRule {
  std::string value;  ///< empty: any; "cuda" stands for "cuda:1", too
  std::span<const Mode> modes;
  std::span<const DeviceChoice::Kind> devices;
};

struct OptionEntry {
  std::string name;          ///< long name without the dashes, e.g. "max-depth"
  std::string short_flag{};  ///< e.g. "-o"; empty: none
  OptionForm form = OptionForm::text;
  std::string placeholder{};  ///< what the help shows for the value, e.g. "N"
  std::string group{};        ///< heading in the help
  std::string help{};         ///< lines of at most 60 characters
  /// Parses and stores a value (of a flag: ignored). Throws Error naming option and value.
  std::function<void(Options&, const std::string&)> set{};
  /// The value as `set` accepts it; empty where the scene or nothing decides.
  std::function<std::string(const Options&)> text{};
  std::vector<OptionRule> rules{};
};

const std::vector<OptionEntry>& option_list();

/// An option and a value of it, as the user wrote them.
struct Setting {
  const OptionEntry* entry;
  std::string value;
};

/// Whether other values mean other samples: renders that differ in nothing else have the same bits
/// on devices of one kind, and their samples can be added.
bool determines_image(const OptionEntry& entry);

/// Throws std::logic_error when there is no such option: a programmer's mistake.
const OptionEntry& find_option(std::string_view name);

/// The name as a JSON key or CSV column: "max-depth" -> "max_depth".
std::string option_key(const OptionEntry& entry);

}  // namespace pt
