// Long work beside Python: other Python threads go on, Ctrl-C ends it, and its progress is told.
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <cstdint>
#include <functional>

namespace pt::python {

/// What the work and the thread that waits for it tell each other.
struct WorkState {
  std::atomic<bool> stop{false};
  std::atomic<std::uint64_t> done{0}, total{0};
};

/// Runs `work` in a thread of its own and waits, without the interpreter's lock. Some times a
/// second it looks for signals and calls `progress(done, total)`, unless that is None; what they
/// raise makes `stop` true, and is thrown when the work has ended. Throws what the work throws.
void run_interruptible(const std::function<void(WorkState&)>& work, nanobind::object progress);

}  // namespace pt::python
