// ptexp: one image, rendered in several ways that can be compared.
#include "app/commands/commands.h"
#include "app/doctor/doctor.h"
#include "app/options/command_line.h"
#include "app/reference/reference.h"
#include "app/terminal/process.h"
#include "common/device/devices.h"
#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/error/terminal.h"
#include "common/image/atomic_file.h"
#include "common/mpi/ranks.h"
#include "common/options/option_names.h"
#include "common/plan/kernels.h"
#include "common/platform/build_info.h"
#include "common/scene/builtin/builtin_scenes.h"
#include "view/view_site.h"

namespace pt {
namespace {

int execute(const RenderCommand& command, Ranks& ranks) { return render_command(command, ranks); }

int execute(const ResumeCommand& command, Ranks& ranks) { return resume_command(command, ranks); }

int execute(const MergeCommand& command) { return merge_command(command); }

int execute(const VerifyCommand& command) { return verify_command(command); }

int execute(const CompareCommand& command) { return compare_command(command); }

int execute(const TraceCommand& command) { return trace_command(command); }

int execute(const RaysCommand& command) { return rays_command(command); }

int execute(const CompactCommand& command) { return compact_command(command); }

int execute(const DoctorCommand& command) { return doctor_command(command); }

int execute(const ViewCommand& command) { return view_command(command); }

int execute(const AdviseCommand& command) { return advise_command(command); }

int execute(const CalibrateCommand& command) { return calibrate_command(command); }

int execute(const MeasureCommand&, const Ranks& ranks) {
  if (!ranks.is_first()) return 0;
  if (ranks.count() > 1)
    throw Error(
        fmt::format("measure: one process renders, and this is a job of {}; expected ptexp "
                    "without a launcher",
                    ranks.count()));
  return measure_command();
}

int execute(const ListScenesCommand&) {
  for (const SceneInfo& scene : scene_list())
    print("{:<13} {}\n", scene.usage(), scene.description);
  return 0;
}

int execute(const ListKernelsCommand&) {
  print_text(kernel_list());
  return 0;
}

int execute(const ListDevicesCommand&) {
  for (const DeviceInfo& device : list_devices())
    print("{:<10} {} ({})\n", to_string(device.choice), device.name, device.detail);
  return 0;
}

int execute(const VersionCommand&) {
  const BuildInfo& build = build_info();
  print("ptexp {}\ncommit {}\nbuild {}, {}\nCUDA {}{}\nMPI {}\n", build.version, build.commit,
        build.build_type, build.compiler, build.cuda, build.fast_math ? ", fast math" : "",
        mpi_version());
  return 0;
}

int execute(const CompletionCommand& command) {
  print("{}", completion_text(command));
  return 0;
}

int execute(const ReferenceCommand& command) {
  print("{}", reference_text(command));
  return 0;
}

int execute(const HelpCommand& command) {
  print("{}", command.text);
  return 0;
}

/// All other commands run in one process.
template <class AnyCommand>
int execute(const AnyCommand& command, const Ranks& ranks) {
  return ranks.is_first() ? execute(command) : 0;
}

int run(Ranks& ranks, const std::vector<std::string>& arguments) {
  try {
    const auto command = parse_command_line(arguments);
    ranks.is_first() ? end_on_signal() : ignore_signals();
    const int code = std::visit([&](const auto& one) { return execute(one, ranks); }, command);
    flush_output();
    return ranks.finish(code);
  } catch (const RanksEnd& end) {
    return ranks.finish(end.code);
  } catch (const std::exception& error) {
    return ranks.fail(message_of(error), 2, print_error);
  }
}

}  // namespace
}  // namespace pt

int main(int argc, char** argv) {
  pt::guard_streams();
  try {
    pt::ChannelSettings settings = pt::channel_settings();
    settings.before_abort = pt::remove_unfinished_file;
    pt::Ranks ranks(pt::open_channel(settings));
    return pt::run(ranks, {argv + 1, argv + argc});
  } catch (const std::exception& error) {
    pt::print_error(pt::message_of(error));
    return 2;
  }
}
