#include "view/view_command.h"

#include <fmt/format.h>

#include "app/terminal/interrupt.h"
#include "app/terminal/progress.h"
#include "app/terminal/standard_output.h"
#include "common/error/terminal.h"
#include "view/http_server.h"
#include "view/live_render.h"
#include "view/view_site.h"

namespace pt {

int view_command(const ViewCommand& command) {
  HttpServer server(command.port);  // before the scene, which may take long
  const std::string token = random_token();
  LiveRender live(command.settings, print_warning);
  ViewSite site(live, token, server.port(), Progress::steady_seconds);
  const std::string address = fmt::format("http://127.0.0.1:{}/{}/", server.port(), token);
  if (!command.is_quiet) {
    print("{} on {}: open this address in a browser of this machine; Ctrl-C ends\n", live.scene(),
          live.device());
  }
  print("{}\n", address);
  flush_output();

  note_signals();
  server.serve(site, [&] {
    site.look_for_viewers();
    if (!interrupted()) return true;
    end_on_signal();  // another one does not wait
    live.end();       // who waits is answered
    return false;
  });
  print_notice("interrupted");
  return exit_code_of_signal();
}

}  // namespace pt
