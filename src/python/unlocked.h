// Work without the interpreter's lock: other Python threads go on, Ctrl-C ends it, its progress is
// reported, and the interpreter waits for it at its end.
#pragma once

#include <cxxabi.h>
#include <nanobind/nanobind.h>

#include <atomic>
#include <cstdint>
#include <functional>

namespace pt::python {

/// Shared by the work and the thread that waits for it.
struct WorkState {
  WorkState();  ///< to be stopped at the interpreter's end
  ~WorkState();
  WorkState(const WorkState&) = delete;
  WorkState& operator=(const WorkState&) = delete;

  std::atomic<bool> stop{false};
  std::atomic<std::uint64_t> done{0}, total{0};
};

/// Releases the interpreter's lock for its lifetime. Python ends a thread that asks for the lock of
/// an interpreter that is ending, wherever that thread is: std::terminate() in a destructor. So
/// from the beginning of its end no thread asks for the lock: it stays here for ever, and the
/// interpreter waits until all threads have done what they do without the lock (at most 10 s).
class Unlocked {
 public:
  Unlocked();
  ~Unlocked();
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  PyThreadState* state_;
};

/// The calling thread never goes on.
[[noreturn]] void wait_forever();

/// Runs `call`, which runs Python code. Before 3.14 Python ends a daemon thread in the midst of
/// such code, when the interpreter ends, by unwinding the stack: std::terminate() at the first
/// function that is noexcept. Such a thread waits here for the process to end instead, as
/// since 3.14. It no longer has the interpreter's lock: objects of Python must not belong to `call`
/// itself, whose destructors have run by then.
template <class Call>
auto run_python(const Call& call) {
  try {
    return call();
  } catch (abi::__forced_unwind&) {
    wait_forever();
  }
}

/// Makes the interpreter stop all work and wait for it at its end.
void add_end(nanobind::module_& m);

/// Runs `work` in a thread of its own and waits for it without the interpreter's lock. Some times a
/// second it looks for signals and calls `progress(done, total)`, unless that is None. What they
/// raise sets `stop` and is returned when the work has ended, so that its result is not lost.
/// Returns None if nothing was raised. Throws what the work throws.
nanobind::object run_interruptible(const std::function<void(WorkState&)>& work,
                                   nanobind::object progress);

}  // namespace pt::python
