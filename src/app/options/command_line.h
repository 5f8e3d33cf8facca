// From the command line to what it asks for.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "app/options/check_options.h"
#include "app/options/compact_options.h"
#include "app/options/trace_options.h"
#include "common/options/options.h"

namespace pt {

struct RenderCommand {
  Options options;
  GivenOptions given;  ///< for check_applicable, once the device is known
};
struct CompareCommand {
  std::string a, b;
  double tolerance = 0;
  std::string difference{};  ///< file for the difference picture; empty: none
};
struct ListScenesCommand {};
struct ListDevicesCommand {};
struct VersionCommand {};
struct HelpCommand {
  std::string text;  ///< to be printed as it is
};

using Command =
    std::variant<RenderCommand, CompareCommand, TraceCommand, RaysCommand, CompactCommand,
                 ListScenesCommand, ListDevicesCommand, VersionCommand, HelpCommand>;

/// `arguments` without the program's name. Throws Error, one line that names the option, for
/// everything that can be refused without a device or a scene.
Command parse_command_line(const std::vector<std::string>& arguments);

}  // namespace pt
