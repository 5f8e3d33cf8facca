// What --help says of a command, as data: shell completions and the man page are made of it.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace pt {

struct OptionText {
  std::vector<std::string> flags;  ///< {"-o", "--output"}; of an argument none
  std::string value;               ///< what stands for it, e.g. "FILE"; empty: a flag
  std::string standard;            ///< the value where it is not given; empty: none
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
  bool takes_render_options = false;  ///< behind a subcommand's name: the program's options, too
};

CommandText describe(const CLI::App& app);

}  // namespace pt
