// What a renderer may take of its device's free memory: less each time that there was too little.
#pragma once

#include <utility>

#include "common/error/host_memory.h"

namespace pt {

struct MemoryShare {
  int halvings = 0;     ///< for ExecutionSettings::memory_halvings
  std::string problem;  ///< the first one; empty: none
  bool is_told = false;

  /// After `error`. Throws the first problem where a smaller share would not help any more.
  void halve(const OutOfMemory& error) {
    if (halvings == 0) problem = error.what();
    constexpr int halvings_max = 6;
    if (halvings == halvings_max) throw Error(problem);
    ++halvings;
  }

  /// A warning that there is less, once; else empty.
  std::string take_warning() {
    if (problem.empty() || std::exchange(is_told, true)) return "";
    return problem + "; goes on with less memory for its paths";
  }
};

/// Returns make(halvings), called with ever smaller shares while it throws OutOfMemory.
template <class Make>
auto make_fitting(MemoryShare& share, Make&& make) {
  for (;;) {
    try {
      return make(share.halvings);
    } catch (const OutOfMemory& error) {
      share.halve(error);
    } catch (const Error&) {
      if (share.halvings == 0) throw;
      throw Error(share.problem);  // too little for the least, by what is left of a share
    }
  }
}

}  // namespace pt
