// Hardware counters of the kernels of a render. Plain data, which
// device/cuda/counter_session_cuda.h fills and the reports print.
#pragma once

#include <array>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

namespace pt {

//   name, CUPTI's metric (Nsight Compute has the same names), its name on chips without that one
//
// All are sums over the GPU's units, so that what several launches have counted can be added, and
// a ratio of two sums is the mean that weighs each launch as it should be.
#define PT_COUNTERS(COUNTER)                                                  \
  COUNTER(time_ns, "gpu__time_duration.sum", "")                              \
  COUNTER(thread_instructions, "smsp__thread_inst_executed.sum", "")          \
  COUNTER(warp_instructions, "smsp__inst_executed.sum", "")                   \
  COUNTER(issue_cycles, "smsp__issue_active.sum", "")                         \
  COUNTER(scheduler_cycles, "smsp__cycles_active.sum", "")                    \
  COUNTER(warp_cycles, "sm__warps_active.sum", "")                            \
  COUNTER(sm_cycles, "sm__cycles_active.sum", "")                             \
  COUNTER(l1_sectors, "l1tex__t_sectors.sum", "")                             \
  COUNTER(l1_hits, "l1tex__t_sectors_lookup_hit.sum", "")                     \
  COUNTER(l2_hits, "lts__t_sectors_lookup_hit.sum", "")                       \
  COUNTER(l2_misses, "lts__t_sectors_lookup_miss.sum", "")                    \
  COUNTER(l2_bytes, "lts__t_bytes.sum", "")                                   \
  COUNTER(l2_sectors_to_sm, "lts__t_sectors_srcunit_tex_op_read.sum", "")     \
  COUNTER(l2_sectors_from_sm, "lts__t_sectors_srcunit_tex_op_write.sum", "")  \
  COUNTER(dram_read_bytes, "dram__bytes_read.sum", "dram__bytes_op_read.sum") \
  COUNTER(dram_written_bytes, "dram__bytes_write.sum", "dram__bytes_op_write.sum")

#define PT_COUNTER_ENUMERATOR(name, metric, other) name,
enum class Counter { PT_COUNTERS(PT_COUNTER_ENUMERATOR) };
#undef PT_COUNTER_ENUMERATOR

struct CounterInfo {
  const char* name;
  const char* metric;
  const char* other_metric;  ///< may be empty
};

#define PT_COUNTER_ROW(name, metric, other) {#name, metric, other},
inline constexpr CounterInfo counter_table[] = {PT_COUNTERS(PT_COUNTER_ROW)};
#undef PT_COUNTER_ROW
#undef PT_COUNTERS
inline constexpr int counter_count = static_cast<int>(std::size(counter_table));

/// [Counter] what was counted.
using CounterValues = std::array<double, counter_count>;

constexpr double value_of(const CounterValues& values, Counter counter) {
  return values[static_cast<std::size_t>(counter)];
}

/// Bytes that a stage moves by the layout of its data (wavefront/pool/stage_bytes.h); 0: not
/// predicted.
struct PredictedBytes {
  double read = 0, written = 0;
};

struct LaunchCounters {
  std::string kernel;
  int wave = -1;  ///< turn of the wavefront's loop, from 0; -1: none
  CounterValues values{};
  PredictedBytes predicted;
};

/// One batch of a render, counted.
struct HardwareCounters {
  std::string problem;     ///< why there are no counters; empty if there are
  int samples = 0;         ///< per pixel, of the batch
  std::uint64_t rays = 0;  ///< of all kinds, of the batch
  int passes = 0;          ///< how often it was rendered: the hardware has few counters at a time
  int warps_per_sm = 0;    ///< that a multiprocessor holds at most
  std::uint64_t uncounted_launches = 0;  ///< the last ones of very many
  std::vector<LaunchCounters> launches;  ///< in their order
};

/// Several launches together.
struct KernelCounters {
  std::string kernel;
  std::uint64_t launches = 0;
  CounterValues values{};  ///< summed
  PredictedBytes predicted;
};

/// By name, in the order of their first launches.
std::vector<KernelCounters> sum_by_kernel(const std::vector<LaunchCounters>& launches);
/// All of them in one.
KernelCounters sum_all(const std::vector<LaunchCounters>& launches);

/// Ratios of counters; NaN if the divisor is 0.
struct CounterRatios {
  double threads_per_instruction;   ///< SIMT efficiency: threads that take part, of 32
  double issue;                     ///< of a scheduler's busy cycles, those that issue: 0..1
  double occupancy;                 ///< of the warps that busy multiprocessors can hold: 0..1
  double l1_hit_rate, l2_hit_rate;  ///< of the sectors asked for: 0..1
};
CounterRatios ratios_of(const CounterValues& values, int warps_per_sm);

/// Bytes between the multiprocessors and the L2 cache, in sectors of 32.
double bytes_to_sm(const CounterValues& values);
double bytes_from_sm(const CounterValues& values);

}  // namespace pt
