#include "python/run_interruptible.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>

namespace pt::python {
namespace {

namespace nb = nanobind;

constexpr std::chrono::milliseconds interval(50);

/// Tells of progress where there is any. All of it needs the interpreter's lock.
class Watcher {
 public:
  Watcher(WorkState& state, nb::object progress) : state_(state), progress_(std::move(progress)) {}

  void look() {
    if (error_) return;
    try {
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
      tell();
    } catch (nb::python_error& error) {
      error_.emplace(std::move(error));
      state_.stop = true;
    }
  }
  /// What was raised, with its traceback; or None.
  nb::object raised() const { return error_ ? nb::borrow(error_->value()) : nb::none(); }

 private:
  void tell() {
    const std::uint64_t done = state_.done, total = state_.total;
    if (progress_.is_none() || total == 0 || (done == told_ && total == told_total_)) return;
    told_ = done, told_total_ = total;
    progress_(done, total);
  }

  WorkState& state_;
  nb::object progress_;
  std::uint64_t told_ = 0, told_total_ = 0;
  std::optional<nb::python_error> error_;
};

/// Joins a thread whatever ends its owner.
struct Joined {
  std::thread& thread;
  WorkState& state;

  ~Joined() {
    state.stop = true;
    if (thread.joinable()) thread.join();
  }
};

}  // namespace

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
    return ended.wait_for(lock, interval, [&] { return has_ended; });
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
