// A command line as data and text. Shell completions and the man page are made of CommandText.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace pt {

struct OptionText {
  std::vector<std::string> flags;  ///< {"-o", "--output"}; empty: an argument
  std::string value;               ///< placeholder, e.g. "FILE"; empty: a flag
  std::string standard;            ///< default value; empty: none
  std::string group;               ///< heading in the help
  std::string help;                ///< in one line

  std::string long_flag() const { return flags.empty() ? "" : flags.back(); }
  /// The words among the alternatives of `value`: "auto|cpu[:N]" -> auto, cpu.
  std::vector<std::string> choices() const;
  bool is_file() const { return value.find("FILE") != std::string::npos; }
  bool is_scene() const { return long_flag() == "--scene"; }
};

struct CommandText {
  std::string name, help, footer;
  std::vector<OptionText> arguments;  ///< files
  std::vector<OptionText> options;
  std::vector<CommandText> subcommands;
  bool takes_render_options = false;  ///< a subcommand that also takes the program's options
};

CommandText describe(const CLI::App& app);

/// The arguments as one line that a POSIX shell splits again.
std::string shell_text(const std::vector<std::string>& arguments);

}  // namespace pt
