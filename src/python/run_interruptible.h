// Long work beside Python: other Python threads go on, Ctrl-C ends it, and its progress is told.
#pragma once

#include <nanobind/nanobind.h>

#include <functional>

#include "python/unlocked.h"

namespace pt::python {

/// Runs `work` in a thread of its own and waits, without the interpreter's lock. Some times a
/// second it looks for signals and calls `progress(done, total)`, unless that is None; what they
/// raise makes `stop` true, and is returned when the work has ended: what it has made is not lost.
/// Returns None where nothing was raised. Throws what the work throws.
nanobind::object run_interruptible(const std::function<void(WorkState&)>& work,
                                   nanobind::object progress);

}  // namespace pt::python
