#include "app/terminal/process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <initializer_list>
#include <sstream>
#include <string>
#include <string_view>

#include "common/error/error.h"
#include "common/error/terminal.h"
#include "common/image/atomic_file.h"

namespace pt {
namespace {

std::atomic<int> signalled{0};
static_assert(std::atomic<int>::is_always_lock_free);  // or a handler must not touch it

std::atomic<const char*> end_text{nullptr};
static_assert(std::atomic<const char*>::is_always_lock_free);

void say(std::string_view text) {
  [[maybe_unused]] const auto written = write(STDERR_FILENO, text.data(), text.size());
}

// Only what a signal handler may call.
void end_now(int signal) {
  remove_unfinished_file();
  say("\nptexp: interrupted");
  say(end_text.load());
  say("\n");
  _exit(128 + signal);
}

void note_signal(int signal) {
  int none = 0;
  signalled.compare_exchange_strong(none, signal);
  hurry_pipe_writers();
}

void handle(void (*handler)(int), std::initializer_list<int> signals) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;  // spares all I/O an EINTR
  sigemptyset(&action.sa_mask);
  for (const int signal : signals) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN)
      sigaction(signal, &action, nullptr);  // nohup, background jobs
  }
}

}  // namespace

void end_on_signal(const char* what_is_lost) {
  end_text = what_is_lost;
  handle(end_now, {SIGINT, SIGTERM, SIGUSR1});
}

void note_signals(bool usr1) {
  handle(note_signal, {SIGINT, SIGTERM});
  if (usr1) handle(note_signal, {SIGUSR1});
  end_text = ": SIGUSR1 keeps samples where there is a --checkpoint; no image written";
}

void ignore_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) std::signal(signal, SIG_IGN);
}

// The name in the line, field 2, may have spaces and ends by the last bracket; proc(5): the process
// was begun at field 22, in clock ticks since the machine was.
double process_age_s() {
  std::ifstream file("/proc/self/stat");
  std::string line;
  std::getline(file, line);
  std::istringstream fields(line.substr(line.find_last_of(')') + 1));
  std::string skipped;
  for (int field = 3; field < 22; ++field) fields >> skipped;
  double begin_ticks = 0;
  timespec now{};
  if (!(fields >> begin_ticks) || clock_gettime(CLOCK_BOOTTIME, &now) != 0) return 0;
  const double begin_s = begin_ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
  return std::max(
      0.0, static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) - begin_s);
}

bool interrupted() { return signalled != 0; }

int exit_code_of_signal() { return 128 + signalled; }

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
