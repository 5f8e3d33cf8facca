// Work without the interpreter's lock, and the interpreter's end meanwhile.
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <cstdint>

namespace pt::python {

/// What the work and the thread that waits for it tell each other.
struct WorkState {
  WorkState();  ///< to be stopped at the interpreter's end
  ~WorkState();
  WorkState(const WorkState&) = delete;
  WorkState& operator=(const WorkState&) = delete;

  std::atomic<bool> stop{false};
  std::atomic<std::uint64_t> done{0}, total{0};
};

/// The thread has not the interpreter's lock for as long as this lives. Python ends a thread that
/// wants the lock of an interpreter that is ending, wherever that thread is: std::terminate() for a
/// destructor. So the interpreter waits at its end until all have the lock again, and who comes
/// later stays away.
class Unlocked {
 public:
  Unlocked();
  ~Unlocked();
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  PyThreadState* state_;
};

/// Has the interpreter stop all work and wait for it at its end.
void add_end(nanobind::module_& m);

}  // namespace pt::python
