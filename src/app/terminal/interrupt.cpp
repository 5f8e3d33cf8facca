#include "app/terminal/interrupt.h"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <initializer_list>
#include <string_view>

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

bool interrupted() { return signalled != 0; }

int exit_code_of_signal() { return 128 + signalled; }

}  // namespace pt
