// What `ptexp compact` measures on a GPU is right before it is timed, and is timed as planned.
#include <algorithm>

#include "cuda_test.h"
#include "wavefront/measure/measure_compaction.h"

namespace pt {
namespace {

constexpr Compaction strategies[] = {Compaction::cub, Compaction::scan, Compaction::atomic,
                                     Compaction::none};

class CudaMeasureCompaction : public CudaTest {};

TEST_F(CudaMeasureCompaction, AGraphGoesThroughAllSets) {
  const auto device = make_compaction_cuda(0);
  for (const std::uint64_t items : {1u << 10, 1u << 18, 1u << 24}) {
    const PassPlan plan = device->plan(items, 3 * items, true);
    EXPECT_GE(plan.passes, plan.sets);
    EXPECT_TRUE(plan.sets == 4096 || 3 * items * plan.sets >= 1u << 28);
    EXPECT_EQ(device->plan(items, 3 * items, false).sets, 1u);
  }
}

TEST_F(CudaMeasureCompaction, KeepsTheContract) {
  const auto device = make_compaction_cuda(0);
  for (const Compaction strategy : strategies) {
    for (const int queues : {1, 2}) {
      for (const std::uint32_t n : {1u, 33u, 511u, 100'001u, 1u << 22}) {
        for (const std::uint32_t run : {1u, 100u}) {
          for (const float density : {0.0f, 0.5f, 1.0f}) {
            const std::vector<StageId> tags = make_tags({n, density, run, queues});
            ASSERT_EQ(contract_breach(strategy, tags, device->compact(strategy, tags, queues)), "")
                << compaction_info(strategy).name << ", " << n << " slots, " << queues
                << " queues, runs of " << run << ", density " << density;
          }
        }
      }
    }
  }
}

TEST_F(CudaMeasureCompaction, TimesEveryRepeat) {
  const auto device = make_compaction_cuda(0);
  const std::vector<StageId> tags = make_tags({10'000, 0.5f, 1, 2});
  const MeasuredRuns runs{1, 3, true};
  const PassPlan plan{7, 3};
  std::vector<std::vector<double>> all;
  for (const CopyWay way : device->copy_ways()) {
    all.push_back(device->time_copy(way, 12'345, plan, runs));
  }
  EXPECT_EQ(all.size(), 2u);
  for (const Compaction strategy : strategies) {
    all.push_back(device->time_compaction(strategy, tags, 2, plan, runs));
  }
  for (const std::vector<double>& times : all) {
    EXPECT_EQ(times.size(), 3u);
    for (const double ms : times) EXPECT_GT(ms, 0.0);
  }
}

// A time is that of one pass: twice the slots take about twice as long, and a copy is as fast as
// this device can be, which is known within a factor.
TEST_F(CudaMeasureCompaction, TimesAreThoseOfOnePass) {
  const auto device = make_compaction_cuda(0);
  const MeasuredRuns runs{2, 5, true};
  const auto gb_per_s = [&](std::uint64_t bytes, std::uint32_t passes) {
    std::vector<double> times = device->time_copy(CopyWay::memcpy, bytes, {passes, 2}, runs);
    std::ranges::sort(times);
    return static_cast<double>(bytes) / times[2] / 1e6;
  };
  const double few = gb_per_s(1 << 28, 2), many = gb_per_s(1 << 28, 8);
  EXPECT_NEAR(few / many, 1.0, 0.25);
  EXPECT_GT(many, 50.0);
  EXPECT_LT(many, 20'000.0);
}

}  // namespace
}  // namespace pt
