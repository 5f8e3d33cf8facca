// The clock of times that are compared with each other.
#pragma once

#include <chrono>

namespace pt {

/// Seconds of the steady clock, since a time of its own.
inline double steady_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace pt
