// Hardware counters of the kernels that this process launches, through CUPTI's range profiler.
//
// Each launch is a range of its own (CUPTI's auto ranges). The hardware has few counters at a time,
// so the same launches are made several times, a pass for each group of counters. Whoever counts
// repeats them (CUPTI's user replay): a render of the same options makes the same launches with the
// same numbers of rays, and its kernels find the caches as the kernel before has left them.
//
// CUPTI is a library of its own (libcupti, of the CUDA toolkit), which is looked for when it is
// needed: the program runs without it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/error/error.h"
#include "common/options/hardware_counters.h"

namespace pt {

/// Why nothing can be counted: no library, no permission, or a call that failed. The message names
/// the call, the reason, and a remedy where there is one.
class CountersUnavailable : public Error {
 public:
  using Error::Error;
};

/// Where libcupti may lie, in the order in which it is looked for: what $PTEXP_CUPTI names, else
/// where the loader looks and where toolkits put it.
std::vector<std::string> cupti_paths();

/// The metrics of counter_table for a chip ("GH100"), as it names them. Needs no GPU. Throws
/// CountersUnavailable where libcupti is missing or the chip lacks one.
std::vector<std::string> metrics_of_chip(const std::string& chip);

/// How CUPTI gets all counters of a launch.
enum class CounterReplay {
  user,   ///< all launches are made again for each pass
  kernel  ///< CUPTI saves the memory, repeats each launch and restores it: to check the other
};

class CounterSession {
 public:
  /// Launches beyond so many are not counted.
  static constexpr std::size_t launches_max = 4000;

  /// `device`: the current CUDA device, whose kernels are counted.
  explicit CounterSession(int device, CounterReplay replay = CounterReplay::user)
      : device_(device), replay_(replay) {}

  /// To be called for each of the render's launches, in their order. `wave`: see LaunchCounters.
  void note_launch(const char* kernel, int wave);

  /// Calls `render` once to see its launches and once for each pass; it must make the same launches
  /// each time, note each, and wait for the last. Throws CountersUnavailable, and whatever `render`
  /// throws. Fills in launches, uncounted_launches and passes.
  HardwareCounters count(const std::function<void()>& render);

 private:
  void check_launches(const std::vector<LaunchCounters>& expected) const;

  int device_;
  CounterReplay replay_;
  std::vector<LaunchCounters> launches_;  ///< noted in this pass
};

}  // namespace pt
