#include <fmt/format.h>

#include <set>
#include <string>

#include "app/commands/commands.h"
#include "app/render/advise.h"
#include "app/render/calibration.h"
#include "app/render/render_session.h"
#include "app/terminal/process.h"
#include "common/error/error.h"
#include "common/error/terminal.h"

namespace pt {

int advise_command(const AdviseCommand& command) {
  const RenderCommand render = make_render_command(command.settings);
  const auto warn = command.is_quiet ? RenderSession::Warn() : print_warning;
  RenderSession session(render, warn);
  note_signals();
  std::set<std::string> tried;
  const auto says = [&](const std::string& way) {
    if (!command.is_quiet && tried.insert(way).second) print_notice("trying " + way);
  };
  const auto advice = advise(session, {command.settings, command.limit_s, interrupted, says});
  if (interrupted()) {
    print_notice("interrupted");
    return exit_code_of_signal();
  }
  if (!advice)
    throw Error(fmt::format("--time-limit {:g}: no render ended before; expected more seconds",
                            command.limit_s));
  print("{}, ", session.scene().name);
  print_text(advice_text(*advice));
  return 0;
}

int calibrate_command(const CalibrateCommand& command) {
  CalibrationRequest request{.settings = command.settings, .stop = interrupted, .says = {}};
  if (!command.is_quiet)
    request.says = [](const std::string& what) { print_notice("measuring: " + what); };
  note_signals();
  const auto calibration = calibrate(request);
  if (!calibration) {
    print_notice("interrupted");
    return exit_code_of_signal();
  }
  const std::string file = store_calibration(*calibration);
  if (!command.is_quiet) print_text(calibration_text(*calibration));
  print("wrote {}\n", file);
  return 0;
}

}  // namespace pt
