#include "python/unlocked.h"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>

namespace pt::python {
namespace {

namespace nb = nanobind;

constexpr std::chrono::seconds patience(10);

struct Away {
  std::mutex mutex;
  std::condition_variable changed;
  int threads = 0;
  std::set<WorkState*> works;
  bool is_ending = false, has_ended = false;
  std::thread::id ender;
};

/// Never destroyed: threads may outlive all that is.
Away& away() {
  static Away& one = *new Away;
  return one;
}

/// At the interpreter's end: Python's other threads are daemons, which nobody has joined.
void end_all() {
  const int threads = nb::cast<int>(nb::module_::import_("threading").attr("active_count")());
  if (threads > 1) nb::set_leak_warnings(false);  // what the others hold is never freed
  Away& a = away();
  {
    const std::lock_guard lock(a.mutex);
    a.is_ending = true;
    a.ender = std::this_thread::get_id();
    for (WorkState* const work : a.works) work->stop = true;
  }
  PyThreadState* const state = PyEval_SaveThread();
  {
    std::unique_lock lock(a.mutex);
    a.changed.wait_for(lock, patience, [&] { return a.threads == 0; });
    a.has_ended = true;
  }
  PyEval_RestoreThread(state);
}

}  // namespace

WorkState::WorkState() {
  Away& a = away();
  const std::lock_guard lock(a.mutex);
  a.works.insert(this);
  stop = a.is_ending;
}

WorkState::~WorkState() {
  Away& a = away();
  const std::lock_guard lock(a.mutex);
  a.works.erase(this);
}

Unlocked::Unlocked() {
  {
    Away& a = away();
    const std::lock_guard lock(a.mutex);
    ++a.threads;
  }
  state_ = PyEval_SaveThread();
}

Unlocked::~Unlocked() {
  Away& a = away();
  {
    std::unique_lock lock(a.mutex);
    const bool stays_away = a.has_ended && a.ender != std::this_thread::get_id();
    lock.unlock();
    while (stays_away) ::pause();
  }
  PyEval_RestoreThread(state_);
  const std::lock_guard lock(a.mutex);
  --a.threads;
  a.changed.notify_all();
}

void add_end(nb::module_& m) {
  nb::module_::import_("atexit").attr("register")(nb::cpp_function(end_all));
  (void)m;
}

}  // namespace pt::python
