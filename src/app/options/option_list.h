// Every option of `ptexp` that fills a field of Options, in one list: the command line, its help,
// the statistics and the image metadata all iterate it. A new option is one entry.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/render/options.h"

namespace pt {

/// How an option is given on the command line, and what it is in JSON.
enum class OptionForm {
  text,    ///< one value, a JSON string
  number,  ///< one value, a JSON number unless its text is not one (such as "auto")
  vector,  ///< three values, X Y Z or X,Y,Z
  list,    ///< one value, may be given several times; a JSON string
  flag     ///< no value, a JSON boolean
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
};

const std::vector<OptionEntry>& option_list();

/// Throws std::logic_error when there is no such option: a programmer's mistake.
const OptionEntry& find_option(const std::string& name);

/// The name as a JSON key or CSV column: "max-depth" -> "max_depth".
std::string option_key(const OptionEntry& entry);

}  // namespace pt
