// Ranks as threads: collective calls, and how they end. tests/mpi/test_mpirun.py has them by MPI.
#include <fmt/format.h>

#include "common/error/error.h"
#include "common/mpi/ranks.h"
#include "fake_worker.h"
#include "film_cases.h"
#include "gtest/gtest.h"
#include "thread_channels.h"

namespace pt {
namespace {

void expect_all(const std::vector<RankOutcome>& outcomes, int code, const std::string& reported) {
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    EXPECT_EQ(outcomes[i].code, code) << "rank " << i;
    EXPECT_EQ(outcomes[i].reported, i == 0 ? reported : "") << "rank " << i;
  }
}

class RankCounts : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Ranks, RankCounts, testing::Values(1, 2, 3, 4, 7, 8, 13));

TEST_P(RankCounts, BroadcastBringsRank0sBytesToAll) {
  std::string large(20'000'003, '\0');
  for (std::size_t i = 0; i < large.size(); ++i) large[i] = static_cast<char>(i * 7 >> 3);
  for (const std::string& text : {std::string(), std::string("a\0b", 3), large}) {
    std::atomic<int> equal = 0;
    const auto outcomes = run_ranks(GetParam(), [&](Ranks& ranks) {
      std::string bytes = ranks.is_first() ? text : "something else";
      ranks.broadcast(bytes);
      equal += bytes == text;
      return 0;
    });
    expect_all(outcomes, 0, "");
    EXPECT_EQ(equal, GetParam());
  }
}

TEST_P(RankCounts, GatherHasOneOfEachRankInTheirOrder) {
  std::vector<std::string> first, second;
  const auto outcomes = run_ranks(GetParam(), [&](Ranks& ranks) {
    const auto a = ranks.gather("a" + std::to_string(ranks.rank()));
    const auto b = ranks.gather("b" + std::to_string(ranks.rank()));  // may overtake another's a
    if (ranks.is_first()) first = a, second = b;
    return 0;
  });
  expect_all(outcomes, 0, "");
  ASSERT_EQ(first.size(), static_cast<std::size_t>(GetParam()));
  ASSERT_EQ(second.size(), first.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i], "a" + std::to_string(i));
    EXPECT_EQ(second[i], "b" + std::to_string(i));
  }
}

TEST_P(RankCounts, AllKnowAllDevices) {
  std::atomic<int> right = 0;
  run_ranks(GetParam(), [&](Ranks& ranks) {
    ranks.announce(std::vector<std::string>(ranks.rank(), "cuda:" + std::to_string(ranks.rank())));
    for (int i = 0; i < ranks.count(); ++i) {
      const std::vector<std::string> expected(i, "cuda:" + std::to_string(i));
      right += ranks.info(i).devices == expected;
    }
    return 0;
  });
  EXPECT_EQ(right, GetParam() * GetParam());
}

TEST_P(RankCounts, TheExitCodeIsThatOfRank0) {
  expect_all(run_ranks(GetParam(), [](Ranks& ranks) { return ranks.is_first() ? 130 : 0; }), 130,
             "");
}

TEST(Ranks, AgreementNamesRankHostAndWhatDiffers) {
  const auto run = [](const std::vector<RankFact>& of_rank_3, bool& worked) {
    return run_ranks(5, [&](Ranks& ranks) {
      const std::vector<RankFact> facts{{"commit", "abc"}, {"options", "spp 4\nwidth 8\nseed 1"}};
      ranks.agree(ranks.rank() == 3 ? of_rank_3 : facts);
      worked = true;
      return 0;
    });
  };
  bool worked = false;
  const std::string same = "spp 4\nwidth 8\nseed 1";
  expect_all(run({{"commit", "abc"}, {"options", same}}, worked), 0, "");
  EXPECT_TRUE(worked);
  worked = false;
  expect_all(run({{"commit", "def"}, {"options", same}}, worked), 2,
             "rank 3 (host1): expected commit abc, has def\n");
  expect_all(run({{"commit", "abc"}, {"options", "spp 4\nwidth 9\nseed 1"}}, worked), 2,
             "rank 3 (host1): expected options width 8, has width 9\n");
  expect_all(run({{"commit", "abc"}, {"options", "spp 4\nwidth 8"}}, worked), 2,
             "rank 3 (host1): expected options seed 1, has none\n");
  expect_all(run({{"commit", "abc"}}, worked), 2,
             "rank 3 (host1): expected to compare options, has \n");
  expect_all(run({{"commit", "abc"}, {"options", same}, {"scene", "x"}}, worked), 2,
             "rank 3 (host1): expected to compare , has scene\n");
  EXPECT_FALSE(worked);
}

TEST(Ranks, AnExceptionOnOneRankEndsAllAndIsReportedOnce) {
  for (const int bad : {0, 1, 2, 5}) {
    for (const bool in_broadcast : {false, true}) {
      const auto outcomes = run_ranks(6, [&](Ranks& ranks) {
        if (ranks.rank() == bad) throw Error("cannot read x.ply");
        std::string bytes(10, 'x');
        if (in_broadcast) ranks.broadcast(bytes);
        ranks.gather("");
        ranks.broadcast(bytes);
        return 0;
      });
      const std::string who =
          bad == 0 ? ""
                   : "rank " + std::to_string(bad) + " (host" + std::to_string(bad / 2) + "): ";
      expect_all(outcomes, 2, who + "cannot read x.ply\n");
    }
  }
}

// Rank 0 has ended well already, and waits for the others.
TEST(Ranks, ALateExceptionIsTheEndOfAll) {
  for (const int bad : {1, 3}) {
    const auto outcomes = run_ranks(4, [&](Ranks& ranks) {
      if (ranks.rank() == bad) throw Error("late");
      return 0;
    });
    EXPECT_EQ(outcomes[0].reported, fmt::format("rank {} (host{}): late\n", bad, bad / 2));
    EXPECT_EQ(outcomes[0].code, 2);
    EXPECT_EQ(outcomes[bad].code, 2);
  }
}

TEST(Ranks, SeveralExceptionsAreReportedAsOne) {
  const auto outcomes = run_ranks(4, [](Ranks& ranks) -> int {
    if (!ranks.is_first()) throw Error("no memory");
    ranks.gather("");
    return 0;
  });
  EXPECT_EQ(outcomes[0].code, 2);
  EXPECT_EQ(std::ranges::count(outcomes[0].reported, '\n'), 1) << outcomes[0].reported;
}

TEST(Ranks, ARankThatIsDeafAfterAFailureIsNotWaitedForLong) {
  std::atomic<bool> is_over = false;
  const auto outcomes = run_ranks(3, [&](Ranks& ranks) {
    if (ranks.rank() == 1) throw Error("bad");
    if (ranks.rank() == 2) {
      while (!is_over) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    } else {
      try {
        ranks.gather("");
      } catch (const Error&) {
        std::thread([&] {
          std::this_thread::sleep_for(std::chrono::seconds(7));
          is_over = true;
        }).detach();
        throw;
      }
    }
    return 0;
  });
  for (const RankOutcome& outcome : outcomes) EXPECT_EQ(outcome.code, 2);
}

/// Units of an image by fake workers, `devices` on each rank but 0, which has none.
std::vector<RankOutcome> distribute(int count, int devices, int failing_rank, FakeGroup& group) {
  return run_ranks(count, [&](Ranks& ranks) {
    std::vector<std::unique_ptr<Worker>> workers;
    std::vector<std::string> names;
    for (int i = 0; i < (ranks.is_first() ? 0 : devices); ++i) {
      names.push_back("cuda:" + std::to_string(i));
      workers.push_back(
          std::make_unique<FakeWorker>(names.back(), ranks.rank() == failing_rank ? 3 : -1));
    }
    ranks.announce(names);
    if (!ranks.is_first()) return serve_units(ranks, workers), 0;
    workers = remote_workers(ranks);
    EXPECT_EQ(workers.size(), static_cast<std::size_t>((count - 1) * devices));
    EXPECT_EQ(workers.back()->name(),
              ranks.info(count - 1).name() + " " + "cuda:" + std::to_string(devices - 1));
    group.run(workers);
    int described = 0;
    for (const auto& worker : workers) {
      RenderReport report;
      worker->describe(report);
      if (report.device_name.empty()) continue;  // others were quicker
      ++described;
      EXPECT_EQ(report.device_name,
                "device of " + worker->name().substr(worker->name().rfind(' ') + 1));
      EXPECT_EQ(report.memory.at(0).size_bytes, 12345u);
    }
    EXPECT_GT(described, 0);
    return 0;
  });
}

TEST(Ranks, UnitsComeBackOnceAndRight) {
  for (const int count : {2, 3, 7}) {
    for (const int devices : {1, 3}) {
      FakeGroup group({5, 3, 17, 60}, 2, 3, 2);
      expect_all(distribute(count, devices, -1, group), 0, "");
      EXPECT_TRUE(group.is_right());
      EXPECT_EQ(group.results, 60u);
      EXPECT_TRUE(group.errors.empty());
    }
  }
}

TEST(Ranks, UnitsOfABrokenDeviceGoToOthers) {
  FakeGroup group({0, 0, 8, 60}, 1, 2, 2);
  expect_all(distribute(3, 1, 1, group), 0, "");
  EXPECT_TRUE(group.is_right());
  EXPECT_EQ(group.errors.at(0), "the device is gone");
}

TEST(Ranks, CancelledUnitsComeBackWithoutSamples) {
  run_ranks(2, [&](Ranks& ranks) {
    std::vector<std::unique_ptr<Worker>> workers;
    if (!ranks.is_first()) workers.push_back(std::make_unique<FakeWorker>("cpu"));
    ranks.announce(std::vector<std::string>(workers.size(), "cpu"));
    if (!ranks.is_first()) return serve_units(ranks, workers), 0;
    workers = remote_workers(ranks);
    workers[0]->cancel();
    Unit unit;
    unit.id = 7, unit.film = blank_film(3, 2), unit.samples = 5;
    workers[0]->begin(std::move(unit));
    std::optional<UnitResult> result;
    while (!result) result = workers[0]->poll();
    EXPECT_EQ(result->id, 7u);
    EXPECT_TRUE(result->film.is_empty());
    EXPECT_EQ(result->film.window, (Window{0, 0, 3, 2}));
    EXPECT_EQ(result->run.ended_by, RunEnd::interrupted);
    return 0;
  });
}

}  // namespace
}  // namespace pt
