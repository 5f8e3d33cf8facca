// Where the time goes, measured on the device itself: the first thread of every kernel reads the
// clock, and the time since the last reading is the previous kernel's. It costs one thread a few
// instructions, needs no event between kernels, and works inside a CUDA graph's loop, where no
// event can be recorded.
#pragma once

#include <chrono>
#include <cstdint>

#include "common/options/stage_info.h"

namespace pt {

struct StageClock {
  std::uint64_t time_ns[stage_count + 1];   ///< by StageId; the last one's is StageId::idle's
  std::uint64_t launches[stage_count + 1];  ///< likewise
  std::uint64_t last_ns;
  StageId running;
};

class WallTimer {
 public:
  double ms() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_)
        .count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace pt
