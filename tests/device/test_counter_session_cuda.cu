// Hardware counters of kernels of which it is known what they do.
#include <algorithm>
#include <cstdlib>
#include <optional>

#include "common/device/cuda/counter_session_cuda.h"
#include "cuda_test.h"

namespace pt {
namespace {

constexpr int block = 256;

__global__ void copy_wide(const uint4* from, uint4* to, int count) {
  const int i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < count) to[i] = from[i];
}

/// Only the first `lanes` threads of a warp do more than begin. The loop's own instructions, which
/// a warp may execute once for all of its threads, are few beside the others.
__global__ void work_in_lanes(float* out, int lanes, int turns) {
  if (static_cast<int>(threadIdx.x % 32) >= lanes) return;
  float x = static_cast<float>(threadIdx.x);
  for (int i = 0; i < turns; ++i) {
#pragma unroll
    for (int k = 0; k < 32; ++k) x = x * 0.5f + static_cast<float>(threadIdx.x + k);
  }
  out[blockIdx.x * blockDim.x + threadIdx.x] = x;
}

class CudaCounterSession : public CudaTest {
 protected:
  static constexpr int count = 1 << 22;  // 64 MiB

  void SetUp() override {
    CudaTest::SetUp();
    if (IsSkipped()) return;
    from.emplace(std::size_t{count});
    to.emplace(std::size_t{count});
  }

  /// Skips where the driver or the machine does not let us count, and says why.
  HardwareCounters measure(CounterReplay replay = CounterReplay::user) {
    HardwareCounters result;
    try {
      CounterSession session(0, replay);
      result = session.count([&] { launch_all(session); });
    } catch (const CountersUnavailable& error) {
      problem = error.what();
    }
    return result;
  }

  void launch_all(CounterSession& session) {
    session.note_launch("copy", 0);
    copy_wide<<<count / block, block>>>(from->data(), to->data(), count);
    session.note_launch("lanes", 1);
    work_in_lanes<<<count / block, block>>>(reinterpret_cast<float*>(to->data()), 8, 200);
    session.note_launch("copy", 2);
    copy_wide<<<count / block, block>>>(from->data(), to->data(), count);
    check_cuda(cudaDeviceSynchronize(), "running a test's kernel");
  }

  std::string problem;
  std::optional<DeviceArray<uint4>> from, to;
};

/// Sums of the copies and of the other kernel.
std::pair<KernelCounters, KernelCounters> kernels_of(const HardwareCounters& counters) {
  const std::vector<KernelCounters> sums = sum_by_kernel(counters.launches);
  EXPECT_EQ(sums.size(), 2u);
  return {sums.at(0), sums.at(1)};
}

TEST_F(CudaCounterSession, CountsWhatKernelsAreKnownToDo) {
  const HardwareCounters counters = measure();
  if (!problem.empty()) GTEST_SKIP() << problem;
  ASSERT_EQ(counters.launches.size(), 3u);
  EXPECT_EQ(counters.uncounted_launches, 0u);
  EXPECT_GE(counters.passes, 1);
  const auto [copies, lanes] = kernels_of(counters);
  EXPECT_EQ(copies.launches, 2u);
  EXPECT_EQ(lanes.launches, 1u);
  const double bytes = 2.0 * count * sizeof(uint4);
  EXPECT_NEAR(bytes_to_sm(copies.values), bytes, 0.01 * bytes);
  EXPECT_NEAR(bytes_from_sm(copies.values), bytes, 0.01 * bytes);
  const CounterRatios full = ratios_of(copies.values, 64), eight = ratios_of(lanes.values, 64);
  EXPECT_NEAR(full.threads_per_instruction, 32, 0.01);
  EXPECT_NEAR(eight.threads_per_instruction, 8, 0.5);
  EXPECT_GT(eight.issue, full.issue) << "one computes, the other waits for memory";
  EXPECT_GT(full.occupancy, 0.3);
  EXPECT_LE(full.occupancy, 1.0);
  EXPECT_LT(full.l1_hit_rate, 0.5) << "nothing is read twice";
  EXPECT_GT(value_of(copies.values, Counter::dram_written_bytes) +
                value_of(copies.values, Counter::dram_read_bytes),
            0.25 * bytes)
      << "more than caches hold";
  EXPECT_GT(value_of(copies.values, Counter::time_ns), 1e3);
}

TEST_F(CudaCounterSession, TheRendersOwnReplayEqualsCuptis) {
  const HardwareCounters own = measure(CounterReplay::user);
  if (!problem.empty()) GTEST_SKIP() << problem;
  const HardwareCounters other = measure(CounterReplay::kernel);
  if (!problem.empty()) GTEST_SKIP() << problem;
  ASSERT_EQ(own.launches.size(), other.launches.size());
  for (std::size_t i = 0; i < own.launches.size(); ++i) {
    for (const Counter counter : {Counter::thread_instructions, Counter::warp_instructions,
                                  Counter::l2_sectors_to_sm, Counter::l2_sectors_from_sm}) {
      const double expected = value_of(other.launches[i].values, counter);
      EXPECT_NEAR(value_of(own.launches[i].values, counter), expected, 0.01 * expected + 100)
          << own.launches[i].kernel << ' ' << counter_table[static_cast<int>(counter)].name;
    }
  }
}

TEST_F(CudaCounterSession, VeryManyLaunchesAreCutOff) {
  HardwareCounters counters;
  try {
    CounterSession session(0);
    counters = session.count([&] {
      for (std::size_t i = 0; i < CounterSession::launches_max + 3; ++i) {
        session.note_launch("lanes", -1);
        work_in_lanes<<<1, 32>>>(reinterpret_cast<float*>(to->data()), 32, 1);
      }
      check_cuda(cudaDeviceSynchronize(), "running a test's kernel");
    });
  } catch (const CountersUnavailable& error) {
    GTEST_SKIP() << error.what();
  }
  EXPECT_EQ(counters.launches.size(), CounterSession::launches_max);
  EXPECT_EQ(counters.uncounted_launches, 3u);
  EXPECT_GT(value_of(counters.launches.back().values, Counter::warp_instructions), 0);
}

TEST_F(CudaCounterSession, OtherLaunchesInEachPassAreAnError) {
  measure();
  if (!problem.empty()) GTEST_SKIP() << problem;
  CounterSession session(0);
  int renders = 0;
  const auto render = [&] {
    for (int i = 0; i <= renders % 2; ++i) {
      session.note_launch("lanes", -1);
      work_in_lanes<<<1, 32>>>(reinterpret_cast<float*>(to->data()), 32, 1);
    }
    ++renders;
    check_cuda(cudaDeviceSynchronize(), "running a test's kernel");
  };
  EXPECT_THROW(session.count(render), CountersUnavailable);
}

// What follows needs CUPTI's library but no GPU.

TEST(CuptiMetrics, EveryChipHasThem) {
  for (const char* chip : {"TU102", "GA100", "GA102", "AD102", "GH100", "GB100", "GB202"}) {
    std::vector<std::string> metrics;
    try {
      metrics = metrics_of_chip(chip);
    } catch (const CountersUnavailable& error) {
      const std::string what = error.what();
      if (what.find("was not found") != std::string::npos) GTEST_SKIP() << what;
      FAIL() << what;
    }
    ASSERT_EQ(metrics.size(), std::size_t{counter_count}) << chip;
    for (int i = 0; i < counter_count; ++i) {
      const CounterInfo& counter = counter_table[i];
      EXPECT_TRUE(metrics[i] == counter.metric || metrics[i] == counter.other_metric) << chip;
    }
  }
}

TEST(CuptiMetrics, ALibraryThatIsMissingIsNamed) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // a process that has not loaded it
  const auto load = [] {
    setenv("PTEXP_CUPTI", "/nowhere/libcupti.so", 1);
    try {
      metrics_of_chip("GH100");
    } catch (const CountersUnavailable& error) {
      std::fputs(error.what(), stderr);
      std::_Exit(3);
    }
    std::_Exit(0);
  };
  EXPECT_EXIT(load(), testing::ExitedWithCode(3), "was not found.*/nowhere/libcupti.so");
}

}  // namespace
}  // namespace pt
