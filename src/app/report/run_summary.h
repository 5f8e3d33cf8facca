// The repeats of a measurement and the hardware counters in a few numbers, which the table, the
// JSON and the CSV share.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "common/options/hardware_counters.h"
#include "common/options/stats.h"

namespace pt {

struct Spread {
  double median = 0;  ///< the mean of the two middle values where their number is even
  double min = 0;
  double max = 0;
};

/// All zero for no values.
Spread spread(std::vector<double> values);

struct StageSummary {
  std::string stage;
  Spread time_ms;              ///< over the repeats
  std::uint64_t launches = 0;  ///< of the last repeat
};

struct RunSummary {
  Spread kernel_ms, wall_ms;         ///< over the repeats
  std::vector<StageSummary> stages;  ///< in the order in which the runs first name them
  std::uint64_t waves = 0;           ///< of the last repeat, as is what follows
  std::uint64_t launches = 0;        ///< of all stages
  int samples_done = 0;              ///< per pixel
  RunEnd ended_by = RunEnd::samples;
  std::optional<double> relative_error;
  std::optional<MetropolisStats> metropolis;
  double mpaths_per_s = 0;  ///< 10^6 paths / median kernel time; 0 where that is 0
  double mrays_per_s = 0;   ///< 10^6 rays of all kinds / median kernel time
};

RunSummary summarize(const RenderReport& report);

std::uint64_t memory_bytes(const RenderReport& report);  ///< the sum of all buffers

/// Name and value of each hardware counter of some launches; NaN where there was nothing to divide
/// by.
std::vector<std::pair<std::string, double>> counter_fields(const KernelCounters& kernel,
                                                           int warps_per_sm);

}  // namespace pt
