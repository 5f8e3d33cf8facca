// What the hardware counted, summed and divided, against numbers worked out by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <set>
#include <string>

#include "common/options/hardware_counters.h"

namespace pt {
namespace {

CounterValues values_of(std::initializer_list<std::pair<Counter, double>> pairs) {
  CounterValues values{};
  for (const auto& [counter, value] : pairs) values[static_cast<std::size_t>(counter)] = value;
  return values;
}

TEST(HardwareCounters, TheTableHasEachCounterOnce) {
  std::set<std::string> names, metrics;
  for (const CounterInfo& counter : counter_table) {
    names.insert(counter.name);
    metrics.insert(counter.metric);
    EXPECT_TRUE(std::string(counter.metric).ends_with(".sum")) << "else it could not be added";
  }
  EXPECT_EQ(names.size(), std::size_t{counter_count});
  EXPECT_EQ(metrics.size(), std::size_t{counter_count});
  EXPECT_STREQ(counter_table[static_cast<int>(Counter::l2_bytes)].metric, "lts__t_bytes.sum");
}

TEST(HardwareCounters, RatiosByHand) {
  const CounterRatios ratios = ratios_of(values_of({{Counter::thread_instructions, 320},
                                                    {Counter::warp_instructions, 20},
                                                    {Counter::issue_cycles, 30},
                                                    {Counter::scheduler_cycles, 120},
                                                    {Counter::warp_cycles, 3200},
                                                    {Counter::sm_cycles, 100},
                                                    {Counter::l1_sectors, 50},
                                                    {Counter::l1_hits, 10},
                                                    {Counter::l2_hits, 30},
                                                    {Counter::l2_misses, 10}}),
                                         64);
  EXPECT_EQ(ratios.threads_per_instruction, 16);
  EXPECT_EQ(ratios.issue, 0.25);
  EXPECT_EQ(ratios.occupancy, 0.5);
  EXPECT_EQ(ratios.l1_hit_rate, 0.2);
  EXPECT_EQ(ratios.l2_hit_rate, 0.75);
}

TEST(HardwareCounters, NothingToDivideByIsNoNumber) {
  const CounterRatios ratios = ratios_of({}, 64);
  for (const double ratio : {ratios.threads_per_instruction, ratios.issue, ratios.occupancy,
                             ratios.l1_hit_rate, ratios.l2_hit_rate}) {
    EXPECT_TRUE(std::isnan(ratio));
  }
}

TEST(HardwareCounters, SectorsHave32Bytes) {
  const CounterValues values =
      values_of({{Counter::l2_sectors_to_sm, 3}, {Counter::l2_sectors_from_sm, 5}});
  EXPECT_EQ(bytes_to_sm(values), 96);
  EXPECT_EQ(bytes_from_sm(values), 160);
}

// A long launch of full warps and a short one of single threads: the mean is that of instructions.
TEST(HardwareCounters, LaunchesWeighAsMuchAsTheyDo) {
  const CounterValues full =
      values_of({{Counter::thread_instructions, 3200}, {Counter::warp_instructions, 100}});
  const CounterValues single =
      values_of({{Counter::thread_instructions, 10}, {Counter::warp_instructions, 10}});
  const std::vector<LaunchCounters> launches{
      {"shade", 0, full, {1, 2}}, {"trace", 0, single, {}}, {"shade", 1, single, {10, 20}}};
  const std::vector<KernelCounters> kernels = sum_by_kernel(launches);
  ASSERT_EQ(kernels.size(), 2u);
  EXPECT_EQ(kernels[0].kernel, "shade");
  EXPECT_EQ(kernels[0].launches, 2u);
  EXPECT_EQ(kernels[0].predicted.read, 11);
  EXPECT_EQ(kernels[0].predicted.written, 22);
  EXPECT_EQ(ratios_of(kernels[0].values, 64).threads_per_instruction, 3210.0 / 110);
  EXPECT_EQ(kernels[1].launches, 1u);
  const KernelCounters all = sum_all(launches);
  EXPECT_EQ(all.launches, 3u);
  EXPECT_EQ(value_of(all.values, Counter::warp_instructions), 120);
}

}  // namespace
}  // namespace pt
