// From the command line to what it asks for.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "app/options/check_options.h"
#include "app/options/command_text.h"
#include "app/options/option_list.h"
#include "app/options/subcommand_options.h"
#include "common/options/options.h"

namespace pt {

/// Continues a checkpoint by its own options, changed by these.
struct ResumeCommand {
  std::string file;
  std::vector<Setting> settings;
};
struct MergeCommand {
  std::string output;
  std::vector<std::string> inputs;
  bool allow_missing = false;  ///< pixels without samples are black
  bool keeps_sums = false;     ///< the output is a checkpoint, too
};
struct VerifyCommand {
  std::string image;
  double share = 0.01;  ///< part of the pixels, in (0, 1]
  std::vector<Setting> settings;
};
/// Serves a page for browsers.
struct ViewCommand {
  int port = 8080;                ///< 0: any free one
  bool is_quiet = false;          ///< prints only the address
  std::vector<Setting> settings;  ///< the scene's name, too
};
/// Measures which way to render is the fastest.
struct AdviseCommand {
  double limit_s = 60;
  bool is_quiet = false;          ///< no progress
  std::vector<Setting> settings;  ///< the scene's name, too
};
struct CompareCommand {
  std::string a, b;
  double tolerance = 0;
  std::string difference{};  ///< file for the difference picture; empty: none
};
struct ListScenesCommand {};
struct ListDevicesCommand {};
struct ListKernelsCommand {};
struct VersionCommand {};
enum class Shell { bash, zsh, fish };
struct CompletionCommand {
  Shell shell;
  CommandText program;
};
enum class ReferencePage { man, markdown };
struct ReferenceCommand {
  ReferencePage page;
  CommandText program;
};
struct HelpCommand {
  std::string text;  ///< to be printed as it is
};

using Command =
    std::variant<RenderCommand, ResumeCommand, MergeCommand, VerifyCommand, CompareCommand,
                 TraceCommand, RaysCommand, CompactCommand, DoctorCommand, MeasureCommand,
                 CalibrateCommand, ViewCommand, AdviseCommand, ListScenesCommand,
                 ListDevicesCommand, ListKernelsCommand, VersionCommand, CompletionCommand,
                 ReferenceCommand, HelpCommand>;

/// `arguments` without the program's name. Throws Error, one line that names the option, for
/// everything that can be refused without a device or a scene.
Command parse_command_line(const std::vector<std::string>& arguments);

}  // namespace pt
