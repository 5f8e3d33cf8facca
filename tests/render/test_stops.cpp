// Renders that end by time or by error: after whole batches, with the image of so many samples.
#include <cmath>

#include "common/film/pixel_statistics.h"
#include "common/render/batches.h"
#include "film_cases.h"

namespace pt {
namespace {

/// A clock of which each sample takes `per_sample` seconds.
struct FakeTime {
  double now = 100;
  double per_sample = 0.01;

  BatchRun run(double seconds, int spp, int per_batch, std::vector<int>* batches = nullptr) {
    RenderHooks hooks;
    hooks.stops = {seconds, 0, [this] { return now; }};
    return for_each_batch(spp, per_batch, 10, hooks, [&](int, int samples) {
      now += per_sample * samples;
      if (batches != nullptr) batches->push_back(samples);
      return true;
    });
  }
};

// The last sample ends nearer to the limit than the one before it did, or one more would.
TEST(TimeLimit, IsMetToHalfASample) {
  for (const double per_sample : {0.0007, 0.01, 0.13, 0.29, 0.35, 0.44, 0.46}) {
    for (const int per_batch : {1, 7, 100000}) {
      FakeTime time{100, per_sample};
      const BatchRun run = time.run(2.0, 1 << 30, per_batch);
      EXPECT_EQ(run.ended_by, RunEnd::time_limit);
      EXPECT_NEAR(time.now - 100, 2.0, 0.5 * per_sample + 1e-9) << per_batch;
      EXPECT_EQ(run.samples, std::lround((time.now - 100) / per_sample));
    }
  }
}

TEST(TimeLimit, BatchesAreSmallAtFirst) {
  FakeTime time;
  std::vector<int> batches;
  time.run(5.0, 1 << 30, 1000, &batches);
  ASSERT_GT(batches.size(), 5u);
  int done = 1;
  EXPECT_EQ(batches[0], 1);
  for (std::size_t i = 1; i < batches.size(); done += batches[i++]) EXPECT_LE(batches[i], done);
  EXPECT_LT(batches.size(), 15u);
}

TEST(TimeLimit, TakesAtLeastOneSampleAndNotMoreThanAskedFor) {
  FakeTime slow{0, 50.0};
  EXPECT_EQ(slow.run(1.0, 100, 10).samples, 1);
  FakeTime fast{0, 1e-6};
  const BatchRun run = fast.run(1.0, 100, 10);
  EXPECT_EQ(run.samples, 100);
  EXPECT_EQ(run.ended_by, RunEnd::samples);
}

// Whoever asks to stop when the last sample is taken gets a whole image.
TEST(Stops, NothingInterruptsARenderThatIsDone) {
  for (const int per_batch : {10, 5}) {
    RenderHooks hooks;
    hooks.stop = [] { return true; };
    const BatchRun run = for_each_batch(10, per_batch, 1, hooks, [](int, int) { return true; });
    EXPECT_EQ(run.samples, per_batch);
    EXPECT_EQ(run.ended_by, per_batch == 10 ? RunEnd::samples : RunEnd::interrupted);
  }
  FakeTime time{0, 0.5};
  EXPECT_EQ(time.run(2.0, 4, 1).ended_by, RunEnd::samples);
  EXPECT_EQ(time.run(2.0, 5, 1).ended_by, RunEnd::time_limit);
}

// Four times the error needs sixteen times the samples; an eighth of the time has an eighth.
TEST(Stops, ProgressKnowsHowManySamplesThereWillBe) {
  double now = 50;
  const StopRule error{0, 0.1, {}}, time{8, 0, [&] { return now; }};
  const StopClock by_error(error), by_time(time);
  now = 51;
  EXPECT_EQ(by_error.expected(100, 1 << 20, 0.4), 1600u);
  EXPECT_EQ(by_error.expected(100, 1000, 0.4), 1000u);
  EXPECT_EQ(by_error.expected(100, 1 << 20, 0.05), 100u);
  EXPECT_EQ(by_error.expected(100, 1 << 20, {}), std::uint64_t{1} << 20);
  EXPECT_EQ(by_time.expected(100, 1 << 20, {}), 800u);
  EXPECT_EQ(by_time.expected(100, 300, {}), 300u);
}

// The error falls as the root of the samples; it is asked at the same numbers whatever the batches.
TEST(TargetError, IsCheckedAtFixedNumbers) {
  for (const int per_batch : {1, 5, 16, 1000}) {
    int done = 0;
    std::vector<int> checks;
    RenderHooks hooks;
    hooks.stops.relative_error = 0.1;
    const BatchRun run = for_each_batch(
        1 << 30, per_batch, 10, hooks, [&](int, int samples) { return done += samples, true; },
        [&] {
          checks.push_back(done);
          return 1.0 / std::sqrt(done);
        });
    EXPECT_EQ(run.ended_by, RunEnd::target_error);
    EXPECT_EQ(checks, (std::vector<int>{16, 20, 25, 31, 38, 47, 58, 72, 90, 112})) << per_batch;
    EXPECT_EQ(run.samples, 112);
    EXPECT_DOUBLE_EQ(run.relative_error.value(), 1.0 / std::sqrt(112.0));
  }
}

Options options_of(const Settings& more) {
  return with(with(Options(), {{"device", "cpu"},
                               {"scene", "cornell"},
                               {"width", "16"},
                               {"height", "12"},
                               {"max-depth", "4"}}),
              more);
}

Rendered render_with_stops(Options options) {
  options.spp = 1 << 30;
  RenderHooks hooks;
  hooks.stops = {options.time_limit, options.target_error, {}};
  return render_options(options, hooks);
}

TEST(Stops, LeaveTheImageOfSoManySamples) {
  for (const Settings& stop : {Settings{{"target-error", "0.2"}}, Settings{{"time-limit", "0.05"}},
                               Settings{{"target-error", "0.1"}, {"filter", "mitchell"}}}) {
    int samples = 0;
    for (const char* mode : {"megakernel", "wavefront", "serial"}) {
      Options options = options_of(stop);
      apply(options, {{"mode", mode}});
      const Rendered stopped = render_with_stops(options);
      EXPECT_LT(stopped.run.samples_done, 1 << 20);
      const bool by_error = options.target_error > 0;
      EXPECT_EQ(stopped.run.ended_by, by_error ? RunEnd::target_error : RunEnd::time_limit);
      if (by_error && samples > 0) {
        EXPECT_EQ(stopped.run.samples_done, samples) << mode;
      }
      samples = stopped.run.samples_done;
      Options whole = options_of({});
      whole.filter = options.filter;
      whole.spp = samples;
      expect_same(render_options(whole), stopped);
    }
  }
}

// The error that is estimated is the one that there is: against the mean of an image of many more
// samples, and with filters of both signs.
TEST(Stops, EstimateTheError) {
  for (const char* filter : {"box", "lanczos"}) {
    const Options options = options_of({{"filter", filter}, {"target-error", "0.15"}});
    const Rendered stopped = render_with_stops(options);
    Options better = options_of({{"filter", filter}, {"spp", "20000"}, {"seed", "7"}});
    const Image reference = render_options(better).image;
    const auto luminance = [](const float* c) {
      return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
    };
    double squares = 0, sum = 0;
    for (std::size_t i = 0; i < reference.rgb.size(); i += 3) {
      const double y = luminance(&reference.rgb[i]);
      const double error = luminance(&stopped.image.rgb[i]) - y;
      squares += error * error;
      sum += y;
    }
    const double pixels = static_cast<double>(reference.rgb.size()) / 3;
    const double found = std::sqrt(squares / pixels) / (sum / pixels);
    // 192 pixels with skewed errors give the root of the mean square to a third.
    EXPECT_NEAR(stopped.run.relative_error.value() / found, 1.0, 0.35) << filter;
    EXPECT_LE(stopped.run.relative_error.value(), 0.15);
  }
}

}  // namespace
}  // namespace pt
