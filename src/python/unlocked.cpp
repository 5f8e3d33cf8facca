#include "python/unlocked.h"

#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
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
  bool is_ending = false;
  std::thread::id ender;

  /// Whether the calling thread must not have the interpreter's lock again. Needs `mutex`.
  bool is_over() const { return is_ending && ender != std::this_thread::get_id(); }
};

/// Never destroyed: threads may outlive static objects.
Away& away() {
  static Away& one = *new Away;
  return one;
}

/// Called at the interpreter's end, when Python's other threads are daemons.
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
  }
  PyEval_RestoreThread(state);
}

bool is_over() {
  Away& a = away();
  const std::lock_guard lock(a.mutex);
  return a.is_over();
}

/// The calling thread, which has the interpreter's lock, gives it away and never goes on.
[[noreturn]] void unlock_forever() {
  PyEval_SaveThread();
  wait_forever();
}

constexpr std::chrono::milliseconds interval(50);

/// Looks for signals and reports progress. Its functions need the interpreter's lock.
class Watcher {
 public:
  Watcher(WorkState& state, nb::object progress) : state_(state), progress_(std::move(progress)) {}

  void look() {
    if (error_) return;
    try {
      if (run_python(PyErr_CheckSignals) != 0) throw nb::python_error();
      tell();
    } catch (nb::python_error& error) {
      error_.emplace(std::move(error));
      state_.stop = true;
    }
  }
  /// The exception with its traceback, or None.
  nb::object raised() const { return error_ ? nb::borrow(error_->value()) : nb::none(); }

 private:
  void tell() {
    const std::uint64_t done = state_.done, total = state_.total;
    if (progress_.is_none() || total == 0 || (done == told_ && total == told_total_)) return;
    told_ = done, told_total_ = total;
    run_python([&] { progress_(done, total); });
  }

  WorkState& state_;
  nb::object progress_;
  std::uint64_t told_ = 0, told_total_ = 0;
  std::optional<nb::python_error> error_;
};

/// Joins a thread in any case.
struct Joined {
  std::thread& thread;
  WorkState& state;

  ~Joined() {
    state.stop = true;
    if (thread.joinable()) thread.join();
  }
};

}  // namespace

WorkState::WorkState() {
  if (is_over()) unlock_forever();
  Away& a = away();
  const std::lock_guard lock(a.mutex);
  a.works.insert(this);
}

WorkState::~WorkState() {
  Away& a = away();
  const std::lock_guard lock(a.mutex);
  a.works.erase(this);
}

Unlocked::Unlocked() {
  if (is_over()) unlock_forever();
  {
    Away& a = away();
    const std::lock_guard lock(a.mutex);
    ++a.threads;
  }
  state_ = PyEval_SaveThread();
}

Unlocked::~Unlocked() {
  Away& a = away();
  const auto leave = [&a] {
    --a.threads;
    a.changed.notify_all();
  };
  {
    std::unique_lock lock(a.mutex);
    if (a.is_over()) {
      leave();
      lock.unlock();
      wait_forever();
    }
  }
  PyEval_RestoreThread(state_);
  const std::lock_guard lock(a.mutex);
  leave();
}

void wait_forever() {
  for (;;) ::pause();
}

void add_end(nb::module_& m) {
  nb::module_::import_("atexit").attr("register")(nb::cpp_function(end_all));
  (void)m;
}

nb::object run_interruptible(const std::function<void(WorkState&)>& work, nb::object progress) {
  WorkState state;
  Watcher watcher(state, std::move(progress));
  std::mutex mutex;
  std::condition_variable ended;
  bool has_ended = false;
  std::exception_ptr problem;
  std::thread thread([&] {
    try {
      work(state);
    } catch (...) {
      problem = std::current_exception();
    }
    const std::lock_guard lock(mutex);
    has_ended = true;
    ended.notify_all();
  });
  const Joined joined{thread, state};
  const auto wait = [&] {
    const Unlocked unlocked;
    std::unique_lock lock(mutex);
    const auto is_done = [&] { return has_ended; };
    // The process does not end in the midst of work: this thread stays until it is done.
    if (!ended.wait_for(lock, interval, is_done) && is_over()) ended.wait(lock, is_done);
    return has_ended;
  };
  while (!wait()) watcher.look();
  {
    const Unlocked unlocked;
    thread.join();
  }
  watcher.look();
  if (problem && watcher.raised().is_none()) std::rethrow_exception(problem);
  return watcher.raised();
}

}  // namespace pt::python
