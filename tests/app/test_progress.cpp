// Progress on terminals and in logs, warm-ups and repeats, and their interruption.
#include <gtest/gtest.h>

#include <csignal>

#include "app/render/rendering.h"
#include "app/terminal/process.h"
#include "app/terminal/progress.h"
#include "temp_folder.h"

namespace pt {
namespace {

TEST(ProgressText, BarRateAndTimeLeft) {
  EXPECT_EQ(progress_text(0, 100, 0, 10), "[..........]   0 %");
  EXPECT_EQ(progress_text(25'000'000, 100'000'000, 2, 20),
            "[#####...............]  25 %  12.50 Msamples/s  0:06 left");
  EXPECT_EQ(progress_text(500, 1000, 0.5, 0), " 50 %  1.0 ksamples/s  0:01 left");
  EXPECT_EQ(progress_text(1000, 1000, 1e-6, 4), "[####] 100 %  1.00 Gsamples/s");
}

TEST(ProgressText, ClockForms) {
  EXPECT_NE(progress_text(1, 755, 1, 0).find("12:34 left"), std::string::npos);
  EXPECT_NE(progress_text(1, 3724, 1, 0).find("1:02:03 left"), std::string::npos);
  EXPECT_NE(progress_text(1, 1'000'000, 1, 0).find("over 100 h left"), std::string::npos);
}

TEST(ProgressText, EdgesStayInRange) {
  EXPECT_EQ(progress_text(0, 0, 1, 4), "[####] 100 %");
  EXPECT_EQ(progress_text(20, 10, 0, 4), "[####] 100 %");
  EXPECT_EQ(progress_text(999, 1000, 0, 4), "[###.]  99 %") << "100 % means done";
}

TEST(ForecastText, SaysWhichStopComesFirst) {
  Options options;
  options.target_error = 0.03f, options.spp = 1 << 30;
  // 16 samples of 1,000 pixels took 2 s.
  RenderProgress progress{1000, 16'000, 1'234'567'000, 2};
  EXPECT_EQ(forecast_text(options, progress),
            "--target-error 0.03: about 1,234,567 samples per pixel, 42:51:59 left");
  progress.total = 32'000;
  EXPECT_EQ(forecast_text(options, progress),
            "--target-error 0.03: about 32 samples per pixel, 0:02 left");
  options.time_limit = 4.01f;
  EXPECT_EQ(
      forecast_text(options, progress),
      "--target-error 0.03: not within --time-limit 4.01, which ends it after about 32 samples");
  options.time_limit = 4.1f;
  EXPECT_EQ(forecast_text(options, progress).find("about 32"), 21u);
  options.spp = 32;
  EXPECT_EQ(forecast_text(options, progress), "--target-error 0.03: not within --spp 32");
  progress.done = 15'000;
  EXPECT_EQ(forecast_text(options, progress), "") << "there is no estimate yet";
  EXPECT_EQ(forecast_text(options, {1000, 32'000, 32'000, 2}), "") << "it is done";
}

/// A progress that writes to a file and takes its time from `now_s`.
class ProgressTest : public testing::Test {
 protected:
  Progress make(ProgressStyle style) {
    return Progress(stream_, style, [this] { return now_s_; });
  }
  std::string written() {
    std::fflush(stream_);
    return read_text(folder_.file("log"));
  }
  ~ProgressTest() override { std::fclose(stream_); }

  TempFolder folder_;
  std::FILE* stream_ = std::fopen(folder_.file("log").c_str(), "w");
  double now_s_ = 1000;
};

TEST_F(ProgressTest, LinesAreOccasional) {
  Progress progress = make(ProgressStyle::lines);
  progress.begin("rendering");
  for (int i = 1; i <= 120; ++i) {
    now_s_ += 0.1;
    progress.update(static_cast<std::uint64_t>(i) * 1000, 200'000);
  }
  progress.finish();
  const std::string text = written();
  EXPECT_EQ(std::ranges::count(text, '\n'), 2) << text;
  EXPECT_TRUE(text.starts_with("rendering  2")) << text;
  EXPECT_EQ(text.find_first_of("\r\x1b"), std::string::npos) << text;
}

TEST_F(ProgressTest, BarIsRedrawnTenTimesASecondAndCleared) {
  Progress progress = make(ProgressStyle::bar);
  progress.begin("render 1 of 2");
  for (int i = 1; i <= 100; ++i) {
    now_s_ += 0.01;
    progress.update(static_cast<std::uint64_t>(i), 100);
  }
  progress.finish();
  progress.finish();
  const std::string text = written();
  EXPECT_GE(std::ranges::count(text, '%'), 8);
  EXPECT_LE(std::ranges::count(text, '%'), 10);
  EXPECT_TRUE(text.ends_with("\r\x1b[K")) << "cleared once";
  EXPECT_EQ(text.find('\n'), std::string::npos);
}

TEST_F(ProgressTest, SilentWritesNothing) {
  Progress progress = make(ProgressStyle::silent);
  progress.begin("rendering");
  now_s_ += 1000;
  progress.update(1, 2);
  progress.finish();
  EXPECT_EQ(written(), "");
}

TEST_F(ProgressTest, AFileIsNoTerminal) {
  EXPECT_EQ(progress_style(stream_, false), ProgressStyle::lines);
  EXPECT_EQ(progress_style(stream_, true), ProgressStyle::silent);
}

/// Renders `batches` batches of one sample per pixel and one pixel.
class FakeRenderer : public Renderer {
 public:
  explicit FakeRenderer(int batches) : batches_(batches) {}
  RenderRun render(const RenderHooks& hooks) override {
    ++renders;
    RenderRun run;
    run.kernel_ms = renders;
    while (run.samples_done < batches_ && !hooks.stop()) {
      ++run.samples_done;
      hooks.progress(static_cast<std::uint64_t>(run.samples_done),
                     static_cast<std::uint64_t>(batches_));
    }
    return run;
  }
  RenderRun render(Film&, int, const RenderHooks& hooks) override { return render(hooks); }
  RenderRun add(int, const RenderHooks& hooks) override { return render(hooks); }
  Image image() override { return {}; }
  void describe(RenderReport&) const override {}

  int renders = 0;

 private:
  int batches_;
};

/// Measures 2 warm-ups and 3 repeats of 4 samples; stop() is true from its `stop_at`-th call on.
Measurement measure_until(int stop_at, FakeRenderer& renderer) {
  Options options;
  options.spp = 4;
  options.warmup = 2;
  options.repeat = 3;
  int calls = 0;
  MeasureHooks hooks;
  hooks.progress = [](std::uint64_t, std::uint64_t) {};
  hooks.stop = [&] { return ++calls >= stop_at; };
  return measure(renderer, options, hooks);
}

TEST(Measure, WarmUpsAreNotCounted) {
  FakeRenderer renderer(4);
  const Measurement measurement = measure_until(INT32_MAX, renderer);
  EXPECT_FALSE(measurement.interrupted);
  EXPECT_EQ(renderer.renders, 5);
  ASSERT_EQ(measurement.runs.size(), 3u);
  EXPECT_EQ(measurement.runs.front().kernel_ms, 3);
  EXPECT_EQ(measurement.runs.back().kernel_ms, 5);
}

TEST(Measure, EachRenderIsNamed) {
  const auto names = [](int warmup, int repeat) {
    FakeRenderer renderer(1);
    Options options;
    options.spp = 1, options.warmup = warmup, options.repeat = repeat;
    std::vector<std::string> labels;
    MeasureHooks hooks;
    hooks.begin = [&](const std::string& label) { labels.push_back(label); };
    hooks.progress = [](std::uint64_t, std::uint64_t) {};
    hooks.stop = [] { return false; };
    measure(renderer, options, hooks);
    return labels;
  };
  using Labels = std::vector<std::string>;
  EXPECT_EQ(names(2, 3), (Labels{"warm-up 1 of 2", "warm-up 2 of 2", "render 1 of 3",
                                 "render 2 of 3", "render 3 of 3"}));
  EXPECT_EQ(names(1, 1), (Labels{"warm-up 1 of 1", "rendering"}));
}

TEST(Measure, StoppedBeforeTheFirstRender) {
  FakeRenderer renderer(4);
  const Measurement measurement = measure_until(1, renderer);
  EXPECT_TRUE(measurement.interrupted);
  EXPECT_TRUE(measurement.runs.empty());
  EXPECT_EQ(renderer.renders, 0);
}

// A render of 4 samples asks stop() once before and four times within: five calls.
TEST(Measure, StoppedWithinAWarmUpKeepsItsSamples) {
  FakeRenderer renderer(4);
  const Measurement measurement = measure_until(4, renderer);
  EXPECT_TRUE(measurement.interrupted);
  ASSERT_EQ(measurement.runs.size(), 1u);
  EXPECT_EQ(measurement.runs[0].samples_done, 2);
}

TEST(Measure, StoppedWithinARepeatLeavesOnlyWhatTheImageShows) {
  FakeRenderer renderer(4);
  const Measurement measurement = measure_until(3 * 5 + 3, renderer);
  EXPECT_TRUE(measurement.interrupted);
  ASSERT_EQ(measurement.runs.size(), 1u);
  EXPECT_EQ(measurement.runs[0].kernel_ms, 4);
  EXPECT_EQ(measurement.runs[0].samples_done, 1);
}

TEST(Measure, StoppedBetweenRendersKeepsTheCompleteOnes) {
  FakeRenderer after_warm_up(4);
  Measurement measurement = measure_until(5 + 1, after_warm_up);
  EXPECT_TRUE(measurement.interrupted);
  ASSERT_EQ(measurement.runs.size(), 1u) << "the image has the warm-up's samples";
  EXPECT_EQ(measurement.runs[0].samples_done, 4);
  FakeRenderer after_repeat(4);
  measurement = measure_until(4 * 5 + 1, after_repeat);
  EXPECT_TRUE(measurement.interrupted);
  EXPECT_EQ(measurement.runs.size(), 2u);
}

/// Shells' background jobs ignore SIGINT.
void let_signals_through() {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
}

TEST(Interrupt, EndsAtOnceWhileThereIsNothingToKeep) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  for (const int signal : {SIGINT, SIGTERM}) {
    EXPECT_EXIT(
        {
          let_signals_through();
          end_on_signal(": no image written");
          std::raise(signal);
          std::exit(1);
        },
        testing::ExitedWithCode(128 + signal), "no image written");
  }
}

TEST(Interrupt, SetsAFlagHoweverOftenItComes) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  for (const int signal : {SIGINT, SIGTERM}) {
    EXPECT_EXIT(
        {
          let_signals_through();
          end_on_signal();
          note_signals();
          if (interrupted()) std::exit(1);
          std::raise(signal);
          std::raise(SIGINT);
          std::raise(SIGTERM);
          std::exit(interrupted() ? exit_code_of_signal() : 2);
        },
        testing::ExitedWithCode(128 + signal), "^$");
  }
}

}  // namespace
}  // namespace pt
