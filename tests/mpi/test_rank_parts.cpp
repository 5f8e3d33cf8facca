// What ranks consist of, without any message: devices, launchers, heartbeats.
#include <map>

#include "common/mpi/channel.h"
#include "common/mpi/processors.h"
#include "gtest/gtest.h"

namespace pt {
namespace {

using Ordinals = std::vector<int>;

TEST(LocalDevices, AreSharedAsTheTableSays) {
  struct Row {
    int ranks, gpus;
    std::vector<Ordinals> expected;  ///< [local rank]
  };
  const std::vector<Row> table{{1, 0, {{}}},
                               {3, 0, {{}, {}, {}}},
                               {1, 1, {{0}}},
                               {1, 4, {{0, 1, 2, 3}}},
                               {2, 4, {{0, 1}, {2, 3}}},
                               {4, 4, {{0}, {1}, {2}, {3}}},
                               {2, 3, {{0}, {1, 2}}},
                               {3, 8, {{0, 1}, {2, 3, 4}, {5, 6, 7}}},
                               {2, 1, {{0}, {0}}},
                               {5, 2, {{0}, {1}, {0}, {1}, {0}}}};
  for (const Row& row : table) {
    for (int rank = 0; rank < row.ranks; ++rank) {
      EXPECT_EQ(local_devices(rank, row.ranks, row.gpus), row.expected[rank])
          << "rank " << rank << " of " << row.ranks << ", " << row.gpus << " GPUs";
    }
  }
}

ProcessorSet processors(std::initializer_list<int> numbers) {
  ProcessorSet set;
  for (const int number : numbers) set.set(number);
  return set;
}

TEST(Processors, AreSharedByThoseWhoMayUseThem) {
  struct Row {
    std::vector<ProcessorSet> ranks;
    std::vector<int> shares;  ///< [local rank]
    int idle;                 ///< of 0 to 7
  };
  const ProcessorSet all = processors({0, 1, 2, 3, 4, 5, 6, 7});
  const ProcessorSet low = processors({0, 1, 2, 3}), high = processors({4, 5, 6, 7});
  const std::vector<Row> table{
      {{all}, {8}, 0},
      {{all, all}, {4, 4}, 0},
      {{all, all, all}, {2, 2, 2}, 0},
      {{low, high}, {4, 4}, 0},  // bound by the launcher: no share of a share
      {{low, low, high, high}, {2, 2, 2, 2}, 0},
      {{low, low, low, high}, {1, 1, 1, 4}, 0},
      {{processors({0}), processors({1})}, {1, 1}, 6},
      {{processors({5}), processors({5}), processors({5})}, {1, 1, 1}, 7},
      {{processors({0, 1, 2}), processors({0, 1, 2}), processors({0, 1, 2})}, {1, 1, 1}, 5},
      {{low, all}, {2, 6}, 0},
      {{{}, {}}, {1, 1}, 0}};  // not known
  for (const Row& row : table) {
    for (int rank = 0; rank < static_cast<int>(row.ranks.size()); ++rank) {
      EXPECT_EQ(processor_share(row.ranks, rank), row.shares[rank])
          << "row " << &row - table.data() << ", rank " << rank;
    }
    EXPECT_EQ(idle_processors(row.ranks, all), row.idle) << "row " << &row - table.data();
  }
}

TEST(Processors, OnesOwnAreLeftAsTheyWere) {
  const ProcessorSet before = own_processors();
  ASSERT_TRUE(before.any());
  const ProcessorSet free = free_processors();
  EXPECT_EQ(free & before, before);
  EXPECT_EQ(own_processors(), before);
}

TEST(Launcher, IsKnownByItsEnvironment) {
  const auto processes = [](std::map<std::string, const char*> environment) {
    return launched_processes([&](const char* name) {
      const auto found = environment.find(name);
      return found == environment.end() ? nullptr : found->second;
    });
  };
  EXPECT_EQ(processes({}), 0);
  EXPECT_EQ(processes({{"OMPI_COMM_WORLD_SIZE", "4"}}), 4);
  EXPECT_EQ(processes({{"PMI_SIZE", "3"}, {"PMI_RANK", "0"}}), 3);
  EXPECT_EQ(processes({{"OMPI_COMM_WORLD_SIZE", "4"}, {"PTEXP_LAUNCHER", "off"}}), 0);
  // A batch script of Slurm, and srun of one task, whose own MPI need not be there.
  EXPECT_EQ(processes({{"SLURM_PROCID", "0"}, {"SLURM_NTASKS", "8"}}), 0);
  EXPECT_EQ(
      processes({{"SLURM_PROCID", "0"}, {"SLURM_STEP_ID", "0"}, {"SLURM_STEP_NUM_TASKS", "1"}}), 0);
  EXPECT_EQ(
      processes({{"SLURM_PROCID", "0"}, {"SLURM_STEP_ID", "0"}, {"SLURM_STEP_NUM_TASKS", "8"}}), 8);
  EXPECT_EQ(processes({{"PMIX_RANK", "1"},
                       {"SLURM_PROCID", "1"},
                       {"SLURM_STEP_ID", "0"},
                       {"SLURM_STEP_NUM_TASKS", "2"}}),
            2);
}

/// A turn of the loop every tenth of a second from `begin` to `end`.
std::optional<int> live(Heartbeats& beats, double begin, double end,
                        const std::vector<int>& heard) {
  for (double now = begin; now < end; now += 0.1) {
    for (const int from : heard) beats.heard(from, now);
    beats.due(now);
    if (const auto lost = beats.lost(now)) return lost;
  }
  return std::nullopt;
}

TEST(Heartbeats, RankZeroMissesARankThatFallsSilent) {
  Heartbeats beats(0, 4, 10, 0);
  EXPECT_EQ(live(beats, 0, 100, {1, 2, 3}), std::nullopt);
  EXPECT_EQ(live(beats, 100, 109.8, {1, 3}), std::nullopt);
  EXPECT_EQ(live(beats, 109.8, 112, {1, 3}), 2);
}

TEST(Heartbeats, OthersWatchRankZeroAlone) {
  Heartbeats beats(2, 4, 10, 0);
  EXPECT_EQ(live(beats, 0, 100, {0}), std::nullopt);
  EXPECT_EQ(live(beats, 100, 114, {1, 3}), 0);
}

// One after the other, a quarter of an interval apart, up to the ninth: one of them tells the rest.
TEST(Heartbeats, RanksMissRankZeroInTurn) {
  const std::pair<int, double> latest[] = {{1, 10},    {2, 10.25}, {3, 10.5},
                                           {8, 11.75}, {9, 12},    {10, 12}};
  for (const auto& [rank, time] : latest) {
    Heartbeats beats(rank, 20, 10, 0);
    EXPECT_EQ(live(beats, 0, 9.95, {}), std::nullopt);
    EXPECT_EQ(beats.lost(time - 0.01), std::nullopt) << rank;
    EXPECT_EQ(beats.lost(time + 0.01), 0) << rank;
  }
}

TEST(Heartbeats, NobodyIsMissedAfterTheLastMessage) {
  Heartbeats beats(0, 2, 10, 0);
  beats.stop_watching(1);
  EXPECT_EQ(live(beats, 0, 100, {}), std::nullopt);
}

TEST(Heartbeats, WhoeverWasSuspendedItselfMissesNobody) {
  Heartbeats beats(0, 2, 10, 0);
  EXPECT_EQ(live(beats, 0, 5, {1}), std::nullopt);
  EXPECT_EQ(live(beats, 1000, 1009, {}), std::nullopt);
  EXPECT_EQ(live(beats, 1009, 1012, {}), 1);
}

TEST(Heartbeats, AreDueOnceASecondWhereTheyAreHeard) {
  Heartbeats beats(0, 3, 60, 0);
  int sent = 0;
  for (double now = 0; now < 10.05; now += 0.1) sent += static_cast<int>(beats.due(now).size());
  EXPECT_NEAR(sent, 20, 2);
  beats.stop_sending(1);
  EXPECT_EQ(beats.due(11.5), std::vector<int>{2});
  Heartbeats other(2, 3, 2, 0);
  EXPECT_EQ(other.due(0.4), std::vector<int>{});
  EXPECT_EQ(other.due(0.6), std::vector<int>{0});  // four within the time
}

}  // namespace
}  // namespace pt
