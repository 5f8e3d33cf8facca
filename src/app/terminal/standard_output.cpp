#include "app/terminal/standard_output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>

#include "common/error/error.h"
#include "common/error/terminal.h"

namespace pt {

void guard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    // A folder can be neither read nor written, under its own name (/dev/stdout) either.
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF) (void)::open("/", O_RDONLY | O_DIRECTORY);
  }
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

void flush_output() {
  const int problem = flush_printed();
  if (problem == 0) return;
  if (problem == EPIPE) {
    std::signal(SIGPIPE, SIG_DFL);
    std::raise(SIGPIPE);
  }
  throw Error(fmt::format("cannot write to the standard output: {}", std::strerror(problem)));
}

}  // namespace pt
