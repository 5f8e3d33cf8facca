// ptexp: one image, rendered in several ways that can be compared.
#include <fmt/format.h>

#include <cctype>
#include <new>
#include <stdexcept>

#include "app/compact_command.h"
#include "app/compare_command.h"
#include "app/interrupt.h"
#include "app/merge_command.h"
#include "app/options/command_line.h"
#include "app/render_command.h"
#include "app/resume_command.h"
#include "app/standard_output.h"
#include "app/trace_command.h"
#include "app/verify_command.h"
#include "common/device/devices.h"
#include "common/options/option_names.h"
#include "common/platform/build_info.h"
#include "common/scene/builtin/builtin_scenes.h"

namespace pt {
namespace {

int execute(const RenderCommand& command) { return render_command(command); }

int execute(const ResumeCommand& command) { return resume_command(command); }

int execute(const MergeCommand& command) { return merge_command(command); }

int execute(const VerifyCommand& command) { return verify_command(command); }

int execute(const CompareCommand& command) {
  return compare_command(command.a, command.b, command.tolerance, command.difference);
}

int execute(const TraceCommand& command) { return trace_command(command); }

int execute(const RaysCommand& command) { return rays_command(command); }

int execute(const CompactCommand& command) { return compact_command(command); }

int execute(const ListScenesCommand&) {
  for (const SceneInfo& scene : scene_list())
    fmt::print("{:<13} {}\n", scene.usage(), scene.description);
  return 0;
}

int execute(const ListDevicesCommand&) {
  for (const DeviceInfo& device : list_devices())
    fmt::print("{:<10} {} ({})\n", to_string(device.choice), device.name, device.detail);
  return 0;
}

int execute(const VersionCommand&) {
  const BuildInfo& build = build_info();
  fmt::print("ptexp {}\ncommit {}\nbuild {}, {}\nCUDA {}{}\n", build.version, build.commit,
             build.build_type, build.compiler, build.cuda, build.fast_math ? ", fast math" : "");
  return 0;
}

int execute(const HelpCommand& command) {
  fmt::print("{}", command.text);
  return 0;
}

/// One line, whatever a file's name contains.
int report_error(std::string message) {
  for (char& c : message)
    if (std::iscntrl(static_cast<unsigned char>(c))) c = '?';
  fmt::print(stderr, "ptexp: error: {}\n", message);
  return 2;
}

}  // namespace
}  // namespace pt

int main(int argc, char** argv) {
  try {
    const auto command = pt::parse_command_line({argv + 1, argv + argc});
    pt::end_on_signal();
    const int code = std::visit([](const auto& one) { return pt::execute(one); }, command);
    pt::flush_output();
    return code;
  } catch (const std::bad_alloc&) {
    return pt::report_error("not enough host memory for this scene and image size");
  } catch (const std::length_error&) {  // a std::vector that no memory could hold
    return pt::report_error("not enough host memory for this scene and image size");
  } catch (const std::exception& error) {
    return pt::report_error(error.what());
  }
}
