// The loop around the Markov chains, on a device that traces nothing and has a clock of its own:
// how long the bootstrap is, what its weights expect, where it ends early.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <vector>

#include "common/error.h"
#include "common/render/metropolis.h"

namespace pt {
namespace {

constexpr std::uint32_t side = 4;  // pixels

/// Bootstrap paths before `dark` have no light, all others a target of 2; what they and the chains
/// splat is counted as one quantum a path.
class ClockedDevice : public ChainDevice {
 public:
  double now_s = 0;
  std::uint32_t dark = 0;
  std::vector<std::uint32_t> traced, splatted;  ///< bootstrap paths of each call
  ChainStep bootstrap_step, chain_step;
  ChainPositions positions;
  std::uint32_t steps = 0;

  void begin_chains(const ChainWindow&) override {}
  bool trace_bootstrap(std::uint32_t first, std::uint32_t count, RenderRun& run,
                       const std::function<bool()>& cancel) override {
    now_s += 0.125, run.kernel_ms += 125;
    if (cancel && cancel()) return false;
    EXPECT_EQ(first, targets_.size());
    for (std::uint32_t i = first; i < first + count; ++i)
      targets_.push_back(i < dark ? 0.0f : 2.0f);
    traced.push_back(count);
    return true;
  }
  void splat_bootstrap(std::uint32_t count, const ChainStep& step, RenderRun&) override {
    splatted.push_back(count);
    bootstrap_step = step;
    sums_ += count;
  }
  std::vector<TargetSum> sum_targets(std::uint32_t paths, RenderRun&) override {
    EXPECT_EQ(paths, targets_.size());
    std::vector<TargetSum> groups(Bootstrap::group_count(paths));
    const Bootstrap bootstrap{targets_.data(), nullptr, nullptr};
    for (std::uint32_t g = 0; g < groups.size(); ++g) groups[g] = sum_group(bootstrap, g, paths);
    return groups;
  }
  void start_chains(const ChainStarts& starts, const ChainStep& step, RenderRun&) override {
    positions = starts.positions;
    chain_step = step;
  }
  void mutate_chains(std::uint32_t chains, const ChainStep& step, std::uint32_t last,
                     RenderRun& run) override {
    EXPECT_EQ(step.kind, ChainStep::Kind::mutate);
    const std::uint32_t count = last - steps;
    now_s += 0.0625 * count, run.kernel_ms += 62.5 * count;
    sums_ += std::uint64_t{chains} * count;
    tally_ = tally_ + ChainTally{30 * count, 6 * count, 70 * count, 49 * count};
    steps = last;
  }
  void finish_chains(std::uint32_t, const ChainStep& step, RenderRun&) override {
    EXPECT_EQ(step.kind, ChainStep::Kind::finish);
  }
  ChainSums take_chain_sums() override {
    return {std::vector<SplatSum>(3 * side * side, std::exchange(sums_, 0)),
            std::exchange(tally_, {}),
            {}};
  }

 private:
  std::vector<float> targets_;
  SplatSum sums_ = 0;
  ChainTally tally_;  ///< of 100 chains: 30 large steps of which 6, 70 small ones of which 49
};

ChainPlan plan_of(std::uint64_t bootstrap, bool is_timed) {
  ChainPlan plan;
  plan.chains = 100;
  plan.bootstrap = bootstrap;
  plan.bootstrap_batch = 1000;
  plan.bootstrap_is_timed = is_timed;
  return plan;
}

struct Outcome {
  RenderRun run;
  Film film;
};
Outcome render_on(ClockedDevice& device, const ChainPlan& plan, int samples, double seconds,
                  RenderHooks hooks = {}) {
  hooks.stops.seconds = seconds;
  hooks.stops.clock = [&] { return device.now_s; };
  Outcome outcome;
  outcome.film.window = {0, 0, side, side};
  outcome.run = render_chains(device, plan, Options{}, samples, hooks, outcome.film);
  return outcome;
}

TEST(RenderChains, ABootstrapIsAsLongAsIsAskedForAndCountsForTheImage) {
  ClockedDevice device;
  const Outcome outcome = render_on(device, plan_of(2500, false), 1000, 0);
  EXPECT_EQ(device.traced, (std::vector<std::uint32_t>{1000, 1000, 500}));
  EXPECT_EQ(device.splatted, device.traced);
  EXPECT_EQ(device.steps, 160u);  // 16 pixels, 100 chains
  EXPECT_EQ(device.positions.paths, 2500u);
  EXPECT_DOUBLE_EQ(device.chain_step.weights.bootstrap_share, 2500.0 / 16000);
  EXPECT_DOUBLE_EQ(device.chain_step.weights.expected, 2);
  EXPECT_DOUBLE_EQ(device.chain_step.weights.brightness, 2);
  // Each path and each mutation has added a quantum to every channel.
  const double per_quantum = side * side / (16000 * device.chain_step.scale);
  const FilmPixel& pixel = outcome.film.pixels[5];
  EXPECT_NEAR(pixel.sum[1] / static_cast<double>(pixel.samples), (2500 + 16000) * per_quantum,
              1e-9 * per_quantum);
}

TEST(RenderChains, ATimedBootstrapEndsAfterHalfOfTheTime) {
  ClockedDevice device;
  const Outcome outcome = render_on(device, plan_of(1 << 20, true), 1 << 20, 2.0);
  EXPECT_EQ(device.traced.size(), 8u);  // of an eighth of a second
  EXPECT_EQ(outcome.run.metropolis->bootstrap, 8000u);
  EXPECT_EQ(outcome.run.ended_by, RunEnd::time_limit);
  EXPECT_NEAR(device.now_s, 2.0, 0.06);
}

// The image is divided by what was mutated, not by what was planned; so are the rates.
TEST(RenderChains, WhatATimeLimitLeavesIsAWholeImage) {
  ClockedDevice device;
  const Outcome outcome = render_on(device, plan_of(1 << 20, true), 1 << 20, 2.0);
  const auto mutations = 100.0 * device.steps;
  EXPECT_NEAR(device.steps, 16u, 1u);  // of a sixteenth of a second, in the second half
  EXPECT_EQ(outcome.run.samples_done, static_cast<int>(mutations / (side * side)));
  const double share = device.chain_step.weights.bootstrap_share;
  const double expected =
      side * side * (share / device.bootstrap_step.scale + 1 / device.chain_step.scale);
  const FilmPixel& pixel = outcome.film.pixels[7];
  EXPECT_NEAR(pixel.sum[2] / static_cast<double>(pixel.samples), expected, 1e-9 * expected);
  const MetropolisStats stats = outcome.run.metropolis.value();
  EXPECT_EQ(stats.chains, 100u);
  EXPECT_EQ(static_cast<double>(stats.mutations), mutations);
  EXPECT_DOUBLE_EQ(stats.large_share, 0.3);
  EXPECT_DOUBLE_EQ(stats.large_acceptance, 0.2);
  EXPECT_DOUBLE_EQ(stats.small_acceptance, 0.7);
  EXPECT_DOUBLE_EQ(stats.bootstrap_ms, 8 * 125);
  EXPECT_DOUBLE_EQ(stats.mutations_per_s, 100 / 0.0625);
}

// The limit is over before any chain has moved: there is an image even so.
TEST(RenderChains, TakeAStepWhenTheTimeIsOver) {
  ClockedDevice device;
  const Outcome outcome = render_on(device, plan_of(5000, false), 1 << 20, 0.2);
  EXPECT_EQ(device.traced.size(), 5u);
  EXPECT_EQ(device.steps, 1u);
  EXPECT_EQ(outcome.run.ended_by, RunEnd::time_limit);
  EXPECT_TRUE(std::isfinite(outcome.film.pixels[0].sum[0]));
}

TEST(RenderChains, AnInterruptionEndsTheBootstrap) {
  ClockedDevice device;
  RenderHooks hooks;
  hooks.stop = [&] { return device.now_s > 0.3; };
  std::vector<std::uint64_t> progress;
  hooks.progress = [&](std::uint64_t done, std::uint64_t total) {
    EXPECT_LE(done, total);
    progress.push_back(done);
  };
  const Outcome outcome = render_on(device, plan_of(1 << 20, false), 1 << 20, 0, hooks);
  EXPECT_EQ(device.traced.size(), 3u);
  EXPECT_EQ(device.steps, 1u);
  EXPECT_EQ(outcome.run.ended_by, RunEnd::interrupted);
  EXPECT_EQ(progress, (std::vector<std::uint64_t>{1000, 2000, 3000, 3100}));
}

TEST(RenderChains, ABatchOfTheBootstrapIsAbandoned) {
  ClockedDevice device;
  RenderHooks hooks;
  hooks.stop = hooks.cancel = [&] { return device.now_s > 0.3; };
  const Outcome some = render_on(device, plan_of(1 << 20, false), 1 << 20, 0, hooks);
  EXPECT_EQ(device.traced.size(), 2u) << "the third was abandoned";
  EXPECT_EQ(device.positions.paths, 2000u);
  EXPECT_EQ(device.steps, 1u);
  EXPECT_EQ(some.run.ended_by, RunEnd::interrupted);
  EXPECT_EQ(some.run.samples_done, 6) << "100 mutations, 16 pixels";
  ClockedDevice at_once;
  hooks.stop = hooks.cancel = [] { return true; };
  const Outcome none = render_on(at_once, plan_of(1 << 20, false), 1 << 20, 0, hooks);
  EXPECT_EQ(at_once.steps, 0u);
  EXPECT_EQ(none.run.ended_by, RunEnd::interrupted);
  EXPECT_EQ(none.run.samples_done, 0);
  EXPECT_EQ(none.film.pixels.size(), std::size_t{side * side});
}

TEST(RenderChains, ATurnIsNoLongerThanThePaceAllows) {
  ClockedDevice device;
  RenderHooks hooks;
  std::vector<std::uint64_t> progress;
  hooks.progress = [&](std::uint64_t done, std::uint64_t) { progress.push_back(done); };
  hooks.stops.clock = [&] { return device.now_s; };
  ChainPlan plan = plan_of(1000, false);
  plan.clock_interval = 1000;
  BatchPace pace(1);
  Film film;
  film.window = {0, 0, side, side};
  render_chains(device, plan, Options{}, 1000, hooks, film, &pace);
  // A step, and then of half a second: eight of a sixteenth.
  ASSERT_GE(progress.size(), 4u);
  EXPECT_EQ((std::vector<std::uint64_t>(progress.begin(), progress.begin() + 4)),
            (std::vector<std::uint64_t>{1100, 1900, 2700, 3500}));
}

// Nothing is expected of batches without light, and they need not be added; but they count.
TEST(RenderChains, TheFirstBatchesMayBeDark) {
  ClockedDevice device;
  device.dark = 2500;
  render_on(device, plan_of(5000, false), 1000, 0);
  EXPECT_EQ(device.traced.size(), 5u);
  EXPECT_EQ(device.splatted.size(), 3u);
  EXPECT_DOUBLE_EQ(device.chain_step.weights.expected, 2.0 * 500 / 3000);
  EXPECT_DOUBLE_EQ(device.chain_step.weights.brightness, 1.0);
  EXPECT_EQ(device.chain_step.scale, 0x1p25 / 1.0);
  EXPECT_EQ(device.bootstrap_step.scale, 0x1p25 / device.bootstrap_step.weights.expected);
  ClockedDevice black;
  black.dark = 5000;
  EXPECT_THROW(render_on(black, plan_of(5000, false), 1000, 0), Error);
}

}  // namespace
}  // namespace pt
