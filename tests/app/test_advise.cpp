// advise() with planted times, and with a scene.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <string>

#include "app/render/advise.h"
#include "common/error/error.h"
#include "render_words.h"

namespace pt {
namespace {

/// A device with planted times and a clock that only renders move.
struct PlantedDevice {
  std::map<std::string, double> times_ms;  ///< of way_text(), for all samples; others do not exist
  std::string chosen = "wavefront";        ///< mode of the default
  double noise = 0.01;                     ///< standard deviation, relative
  double drift_per_s = 0;                  ///< by which everything slows down
  double build_ms = 0;
  int wanted = 64;
  double clock_s = 0;
  std::mt19937 random{7};
  std::vector<std::string> rendered{};

  static bool has(const WayOptions& options, const std::string& name) {
    return std::ranges::find(options, name, &WayOptions::value_type::first) != options.end();
  }

  std::string mode_of(const WayOptions& options) const {
    for (const auto& [name, value] : options)
      if (name == "mode") return value;
    return chosen;
  }

  /// Without what equals the default.
  std::string key(WayOptions options) const {
    std::erase_if(options, [&](const auto& one) {
      return one == WayOptions::value_type("mode", chosen) ||
             one == WayOptions::value_type("builder", "sah");
    });
    return way_text(options);
  }

  WayMeasurer measurer() {
    WayMeasurer measurer;
    measurer.clock_s = [this] { return clock_s; };
    measurer.plan = [this](const WayOptions& options) {
      if (!times_ms.contains(key(options))) throw Error("no such way");
      std::vector<Decision> plan = {{"mode", mode_of(options), "it is planted"},
                                    {"builder", "sah", ""}};
      for (const auto& [name, value] : options)
        if (name != "mode" && name != "builder") plan.push_back({name, value, ""});
      for (const auto& [name, value] : options)
        if (name == "builder") plan[1].value = value;
      return plan;
    };
    measurer.render = [this](const WayOptions& options, const WayWork& work, bool warms_up,
                             bool) -> std::optional<WayRun> {
      rendered.push_back(key(options));
      std::normal_distribution<double> normal(1, noise);
      WayRun run;
      run.kernel_ms = times_ms.at(key(options)) * work.samples / wanted * work.scale * work.scale *
                      normal(random) * (1 + drift_per_s * clock_s);
      run.wall_ms = run.kernel_ms;
      run.build_ms = build_ms;
      run.device = "planted";
      run.stages = {{"intersect", 0.75 * run.kernel_ms, 1},
                    {"shade_surface", 0.25 * run.kernel_ms, 1}};
      const double seconds = 1e-3 * run.wall_ms * (warms_up ? 2 : 1);
      clock_s += std::min(seconds, work.limit_s);
      if (seconds > work.limit_s) return std::nullopt;
      return run;
    };
    return measurer;
  }

  Advice advice(const GivenOptions& given = {}, double limit_s = 60) {
    const WayMeasurer mine = measurer();
    return advise(mine, wanted, given, limit_s).value();
  }
};

TEST(Advise, FindsTheFastestWayAndItsRatio) {
  PlantedDevice device{.times_ms = {{"the default", 300},
                                    {"--mode megakernel", 360},
                                    {"--accel bvh2", 310},
                                    {"--mode megakernel --accel bvh2", 200},
                                    {"--stages fused", 900}}};
  const Advice advice = device.advice();
  EXPECT_EQ(way_text(advice.best().options), "--mode megakernel --accel bvh2");
  EXPECT_EQ(advice.best().word, "faster");
  EXPECT_LE(advice.best().low, 1.5);
  EXPECT_GE(advice.best().high, 1.5);
  EXPECT_NEAR(advice.best().ratio, 1.5, 0.02);
  EXPECT_LT(advice.best().high - advice.best().low, 0.05);
  EXPECT_EQ(advice.tried, 5);
  EXPECT_GE(advice.rounds, 5);
  // What is far behind takes no turns.
  EXPECT_LE(std::ranges::count(device.rendered, "--stages fused"), 1);
  const std::string text = advice_text(advice);
  EXPECT_TRUE(text.starts_with("planted: use --mode megakernel --accel bvh2, 1.5")) << text;
  EXPECT_LE(std::ranges::count(text, '\n'), 10) << text;
  EXPECT_NE(text.find("intersect 75 %, shade_surface 25 %"), std::string::npos) << text;
  EXPECT_NE(text.find("it is planted"), std::string::npos) << text;
}

// Every seed: chance must not make a way that is as fast the better one.
TEST(Advise, KeepsTheDefaultWhereNothingIsFaster) {
  int wrong = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    PlantedDevice device{.times_ms = {{"the default", 300},
                                      {"--mode megakernel", 300},
                                      {"--accel bvh2", 298},
                                      {"--accel cwbvh", 330}}};
    device.random.seed(seed);
    const Advice advice = device.advice();
    wrong += &advice.best() != &advice.standard;
  }
  EXPECT_EQ(wrong, 0);
}

TEST(Advise, MeasuresInTurnsSoThatADriftDoesNotCount) {
  PlantedDevice device{.times_ms = {{"the default", 300}, {"--mode megakernel", 291}},
                       .noise = 0.002,
                       .drift_per_s = 0.02};
  const Advice advice = device.advice();
  ASSERT_EQ(advice.ways.size(), 1u);
  EXPECT_NEAR(advice.ways[0].ratio, 300.0 / 291, 0.006);
  EXPECT_EQ(advice.ways[0].word, "faster");
}

TEST(Advise, TheTreeCounts) {
  PlantedDevice device{.times_ms = {{"the default", 300}, {"--mode megakernel", 150}}};
  device.build_ms = 1000;
  EXPECT_NEAR(device.advice().ways.at(0).ratio, 1300.0 / 1150, 0.01);
}

TEST(Advise, KeepsWhatTheUserGave) {
  PlantedDevice device{.times_ms = {{"the default", 300},
                                    {"--mode megakernel", 100},
                                    {"--accel bvh2", 100},
                                    {"--stages fused", 200}}};
  const Advice advice = device.advice({"mode", "accel"});
  EXPECT_EQ(way_text(advice.best().options), "--stages fused");
  EXPECT_EQ(advice.tried, 2);
  EXPECT_EQ(advice_text(advice).find("it is planted"), std::string::npos);
}

TEST(Advise, EndsInTimeWithFewerSamplesOfALongRender) {
  PlantedDevice device{.times_ms = {{"the default", 640'000}, {"--mode megakernel", 320'000}}};
  device.wanted = 6400;  // 0.1 s each
  const Advice advice = device.advice({}, 30);
  EXPECT_LE(device.clock_s, 30);
  EXPECT_LT(advice.work.samples, 10);
  EXPECT_NEAR(advice.ways.at(0).ratio, 2, 0.05);
  EXPECT_NEAR(advice.standard.total_ms, 640'000, 20'000);
}

TEST(Advise, RendersASmallerImageWhereOneSampleTakesLong) {
  PlantedDevice device{.times_ms = {{"the default", 640'000}, {"--mode megakernel", 320'000}}};
  const Advice advice = device.advice();  // 10 s and 5 s each
  EXPECT_LE(device.clock_s, 60 + 20);
  EXPECT_EQ(advice.work.samples, 1);
  EXPECT_LT(advice.work.scale, 0.3);
  EXPECT_GE(advice.rounds, 5);
  EXPECT_NEAR(advice.ways.at(0).ratio, 2, 0.05);
  EXPECT_NEAR(advice.standard.total_ms, 640'000, 20'000);
}

TEST(Advise, GivesUpWhatTakesManyTimesAsLong) {
  PlantedDevice device{
      .times_ms = {{"the default", 300}, {"--mode megakernel", 310}, {"--accel bvh2", 30'000'000}}};
  const Advice advice = device.advice();
  EXPECT_LT(device.clock_s, 60);
  EXPECT_GE(advice.rounds, 5);
  EXPECT_EQ(advice.ways.size(), 1u);
}

TEST(Advise, AWayThatDoesNotExistIsLeftOut) {
  PlantedDevice device{.times_ms = {{"the default", 300}}};
  const Advice advice = device.advice();
  EXPECT_TRUE(advice.ways.empty());
  EXPECT_EQ(&advice.best(), &advice.standard);
  PlantedDevice nothing;
  EXPECT_THROW(nothing.advice(), Error);
}

TEST(Advise, WithoutTimeThereIsNoAdvice) {
  PlantedDevice device{.times_ms = {{"the default", 300}}};
  WayMeasurer measurer = device.measurer();
  measurer.render = [](const WayOptions&, const WayWork&, bool, bool) {
    return std::optional<WayRun>();
  };
  EXPECT_FALSE(advise(measurer, 1, {}, 60));
}

TEST(Advise, OfAScene) {
  const std::vector<Setting> settings = settings_from({{"scene", "spheres"},
                                                       {"spheres", "20"},
                                                       {"device", "cpu"},
                                                       {"threads", "1"},
                                                       {"width", "16"},
                                                       {"height", "8"},
                                                       {"spp", "2"},
                                                       {"max-depth", "3"}});
  RenderSession session(make_render_command(settings), {});
  std::set<std::string> tried;
  const auto never = [] { return false; };
  const auto advice =
      advise(session, {settings, 1000, never, [&](const std::string& way) { tried.insert(way); }});
  ASSERT_TRUE(advice);
  for (const char* way : {"--mode megakernel", "--accel bvh2", "--stages fused"})
    EXPECT_TRUE(std::ranges::any_of(tried, [&](const std::string& one) {
      return one.find(way) != std::string::npos;
    })) << way;
  EXPECT_EQ(advice->work.samples, 2);
  EXPECT_GE(advice->rounds, 5);
  const auto megakernel = std::ranges::find(advice->ways, "megakernel", &AdvisedWay::mode);
  ASSERT_NE(megakernel, advice->ways.end());
  EXPECT_EQ(advice->standard.mode, "wavefront");
  EXPECT_EQ(advice->standard.run.counts.paths, 16u * 8 * 2);
  EXPECT_EQ(advice->standard.run.counts.rays, megakernel->run.counts.rays);  // the same image
  EXPECT_GT(advice->standard.total_ms, 0);
  EXPECT_FALSE(advise(session, {settings, 1000, [] { return true; }, {}}));
}

}  // namespace
}  // namespace pt
