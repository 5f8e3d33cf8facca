#include "app/interrupt.h"

#include <atomic>
#include <csignal>

namespace pt {
namespace {

std::atomic<bool> signalled{false};
static_assert(std::atomic<bool>::is_always_lock_free);  // or a handler must not touch it

void handle_interrupt(int) { signalled = true; }

}  // namespace

void catch_interrupt() {
  struct sigaction action {};
  action.sa_handler = handle_interrupt;
  // RESETHAND gives the second signal its usual effect; RESTART spares all I/O an EINTR.
  action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
}

bool interrupted() { return signalled; }

}  // namespace pt
