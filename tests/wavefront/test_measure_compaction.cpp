// What `ptexp compact` measures is right before it is timed: the tags, the check of a result, the
// bytes, and the passes on the CPU.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "wavefront/measure/measure_compaction.h"

namespace pt {
namespace {

constexpr Compaction strategies[] = {Compaction::cub, Compaction::scan, Compaction::atomic,
                                     Compaction::none};

std::vector<StageId> tags_of(std::uint32_t items, float density, std::uint32_t run, int queues) {
  return make_tags({items, density, run, queues});
}

TEST(CompactionTags, AreAsDenseAsAsked) {
  constexpr std::uint32_t n = 100'000;
  for (const float density : {0.0f, 0.1f, 0.5f, 0.9f, 1.0f}) {
    for (const int queues : {1, 2}) {
      const std::vector<StageId> tags = tags_of(n, density, 1, queues);
      ASSERT_EQ(tags.size(), n);
      const double p = static_cast<double>(density);
      const auto limit = [](double mean) { return 5 * std::sqrt(mean * (1 - mean) / n); };
      const auto part = [&](StageId tag) {
        return static_cast<double>(std::ranges::count(tags, tag)) / n;
      };
      EXPECT_NEAR(part(free_slot), 1 - p, limit(p));
      EXPECT_NEAR(part(measured_stages[0]), p / queues, limit(p / queues));
      EXPECT_NEAR(part(measured_stages[0]) + part(measured_stages[1]), p, limit(p));
      EXPECT_EQ(part(measured_stages[1]) > 0, queues == 2 && p > 0);
      EXPECT_EQ(tags, tags_of(n, density, 1, queues));
    }
  }
}

TEST(CompactionTags, NeighboursAreInRuns) {
  for (const std::uint32_t run : {1u, 7u, 64u, 5000u}) {
    const std::vector<StageId> tags = tags_of(4999, 0.5f, run, 2);
    std::uint32_t changes = 0;
    for (std::uint32_t i = 1; i < tags.size(); ++i) {
      if (tags[i] == tags[i - 1]) continue;
      ++changes;
      EXPECT_EQ(i % run, 0u) << run;
    }
    // 1/4 + 2/16 of two runs side by side are alike.
    const double runs = std::ceil(4999.0 / run), expected = (runs - 1) * 0.625;
    EXPECT_NEAR(changes, expected, 5 * std::sqrt(expected) + 1e-9) << run;
  }
}

/// What a pass should leave, found slot by slot.
CompactionResult right_result(const std::vector<StageId>& tags, int queues, bool gathers) {
  CompactionResult result;
  for (int q = 0; q < queues; ++q) {
    std::vector<std::uint32_t> queue(tags.size(), CompactionResult::unwritten);
    std::uint32_t count = 0;
    for (std::uint32_t slot = 0; slot < tags.size(); ++slot) {
      if (tags[slot] != measured_stages[q]) continue;
      if (gathers) queue[count] = slot;
      ++count;
    }
    result.counts.push_back(count);
    result.queues.push_back(queue);
  }
  return result;
}

TEST(CompactionContract, SeesEveryBreach) {
  const std::vector<StageId> tags = tags_of(100, 0.5f, 1, 2);
  for (const Compaction strategy : strategies) {
    SCOPED_TRACE(compaction_info(strategy).name);
    const bool gathers = strategy != Compaction::none;
    const CompactionResult right = right_result(tags, 2, gathers);
    ASSERT_GT(right.counts[1], 10u);
    EXPECT_EQ(contract_breach(strategy, tags, right), "");
    const auto breach = [&](auto&& change) {
      CompactionResult result = right;
      change(result.counts[1], result.queues[1]);
      return contract_breach(strategy, tags, result);
    };
    using Queue = std::vector<std::uint32_t>;
    EXPECT_NE(breach([](std::uint32_t& count, Queue&) { ++count; }).find("shade_miss counts"),
              std::string::npos);
    EXPECT_NE(breach([](std::uint32_t& count, Queue&) { --count; }), "");
    EXPECT_NE(breach([](std::uint32_t&, Queue& queue) { queue.back() = 5; }).find("beyond"),
              std::string::npos);
    const std::string swapped =
        breach([](std::uint32_t&, Queue& queue) { std::swap(queue[0], queue[1]); });
    EXPECT_EQ(swapped.empty(), strategy == Compaction::atomic || !gathers)
        << "only appended slots have no order";
    if (!gathers) continue;
    EXPECT_NE(breach([](std::uint32_t&, Queue& queue) { queue[3] = queue[4]; }), "") << "twice";
    EXPECT_NE(breach([&](std::uint32_t&, Queue& queue) { queue[3] = right.queues[0][3]; }), "")
        << "another queue's";
    EXPECT_NE(breach([](std::uint32_t&, Queue& queue) { queue[3] = CompactionResult::unwritten; }),
              "")
        << "a hole";
  }
}

TEST(CompactionBytes, AreTagsAndNumbers) {
  EXPECT_EQ(moved_bytes(Compaction::cub, 1000, 250), 2000u);
  EXPECT_EQ(moved_bytes(Compaction::atomic, 1000, 1000), 5000u);
  EXPECT_EQ(moved_bytes(Compaction::none, 1000, 250), 1000u);
}

TEST(CompactionPlan, MakesTimesLongAndCachesUseless) {
  EXPECT_EQ(count_passes(1 << 28, 1 << 24), 16u);
  EXPECT_EQ(count_passes(1 << 28, 1 << 10), 256u);
  EXPECT_EQ(count_passes(1 << 28, 1 << 30), 1u);
  EXPECT_EQ(count_sets(1 << 28, 3 << 24), 6u);
  EXPECT_EQ(count_sets(1 << 28, 1 << 28), 1u);
  EXPECT_EQ(count_sets(1 << 28, 5ull << 30), 1u);
  EXPECT_EQ(count_sets(1 << 28, 1 << 10), 4096u);
  EXPECT_EQ(count_sets(0, 1 << 10), 1u) << "warm";
  const PassPlan plan = make_compaction_cpu()->plan(1 << 20, 3 << 20, true);
  EXPECT_EQ(plan.passes, 4u);
  EXPECT_EQ(plan.sets, 22u);
  EXPECT_EQ(make_compaction_cpu()->plan(1 << 20, 3 << 20, false).sets, 1u);
}

TEST(CompactionOnTheCpu, KeepsTheContract) {
  const auto device = make_compaction_cpu();
  for (const Compaction strategy : strategies) {
    for (const int queues : {1, 2}) {
      for (const std::uint32_t n : {1u, 511u, 100'000u}) {
        for (const std::uint32_t run : {1u, 100u}) {
          const std::vector<StageId> tags = tags_of(n, 0.5f, run, queues);
          EXPECT_EQ(contract_breach(strategy, tags, device->compact(strategy, tags, queues)), "");
        }
      }
    }
  }
}

TEST(CompactionOnTheCpu, TimesEveryRepeat) {
  const auto device = make_compaction_cpu();
  const std::vector<StageId> tags = tags_of(10'000, 0.5f, 1, 2);
  const MeasuredRuns runs{1, 3, true};
  const PassPlan plan{7, 3};
  std::vector<std::vector<double>> all{device->time_copy(CopyWay::memcpy, 12'345, plan, runs)};
  for (const Compaction strategy : strategies) {
    all.push_back(device->time_compaction(strategy, tags, 2, plan, runs));
  }
  for (const std::vector<double>& times : all) {
    EXPECT_EQ(times.size(), 3u);
    for (const double ms : times) EXPECT_GT(ms, 0.0);
  }
}

}  // namespace
}  // namespace pt
