#include "common/options/hardware_counters.h"

#include <algorithm>
#include <limits>

namespace pt {
namespace {

constexpr double sector_bytes = 32;

void add(KernelCounters& sum, const LaunchCounters& launch) {
  ++sum.launches;
  for (std::size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += launch.values[i];
  sum.predicted.read += launch.predicted.read;
  sum.predicted.written += launch.predicted.written;
}

double ratio(double part, double whole) {
  return whole > 0 ? part / whole : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

std::vector<KernelCounters> sum_by_kernel(const std::vector<LaunchCounters>& launches) {
  std::vector<KernelCounters> sums;
  for (const LaunchCounters& launch : launches) {
    auto found = std::ranges::find(sums, launch.kernel, &KernelCounters::kernel);
    if (found == sums.end()) {
      found = sums.emplace(sums.end());
      found->kernel = launch.kernel;
    }
    add(*found, launch);
  }
  return sums;
}

KernelCounters sum_all(const std::vector<LaunchCounters>& launches) {
  KernelCounters sum;
  for (const LaunchCounters& launch : launches) add(sum, launch);
  return sum;
}

CounterRatios ratios_of(const CounterValues& values, int warps_per_sm) {
  const auto get = [&](Counter counter) { return value_of(values, counter); };
  using enum Counter;
  return {ratio(get(thread_instructions), get(warp_instructions)),
          ratio(get(issue_cycles), get(scheduler_cycles)),
          ratio(get(warp_cycles), get(sm_cycles) * warps_per_sm),
          ratio(get(l1_hits), get(l1_sectors)), ratio(get(l2_hits), get(l2_hits) + get(l2_misses))};
}

double bytes_to_sm(const CounterValues& values) {
  return sector_bytes * value_of(values, Counter::l2_sectors_to_sm);
}

double bytes_from_sm(const CounterValues& values) {
  return sector_bytes * value_of(values, Counter::l2_sectors_from_sm);
}

}  // namespace pt
