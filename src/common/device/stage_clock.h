// Where the time goes, measured on the device itself: the first thread of every kernel reads the
// clock, and the time since the last reading is the previous kernel's. It costs one thread a few
// instructions, needs no event between kernels, and works inside a CUDA graph's loop, where no
// event can be recorded.
#pragma once

#include <cstdint>

namespace pt {

/// The kernels that have a time of their own. The first ones are StageId's.
enum class ClockId {
  generate,
  intersect,
  shade_miss,
  shade_surface,
  shadow,
  finish,
  accumulate,
  compact,
  begin_wave,
  megakernel,
  render_init,
  idle
};
inline constexpr int clock_count = static_cast<int>(ClockId::idle) + 1;

struct StageClock {
  std::uint64_t time_ns[clock_count];
  std::uint64_t launches[clock_count];
  std::uint64_t last_ns;
  ClockId running;
};

}  // namespace pt
