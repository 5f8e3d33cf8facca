// Several devices make the image of one, bit by bit; a group goes on where workers fail, and ends
// with whole samples where it is interrupted.
#include <fmt/format.h>

#include <ctime>
#include <functional>
#include <future>
#include <set>
#include <thread>
#include <utility>

#include "app/render/rendering.h"
#include "common/distribute/group_renderer.h"
#include "common/film/develop.h"
#include "film_cases.h"

namespace pt {
namespace {

std::string error_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

Options small(const Settings& more = {}) {
  return with(with(Options(), {{"device", "cpu"},
                               {"width", "37"},
                               {"height", "29"},
                               {"spp", "6"},
                               {"max-depth", "5"},
                               {"threads", "2"}}),
              more);
}

struct Group {
  std::shared_ptr<ResultBell> bell = std::make_shared<ResultBell>();
  std::unique_ptr<GroupRenderer> renderer;

  Group(const Options& options, const SceneData& scene, int devices, GroupHooks hooks = {}) {
    std::vector<DeviceInfo> infos(static_cast<std::size_t>(devices), choose_device(options.device));
    for (int i = 0; i < devices; ++i) {
      infos[static_cast<std::size_t>(i)].choice.index = i;
      infos[static_cast<std::size_t>(i)].properties.threads = 1;
    }
    renderer = std::make_unique<GroupRenderer>(
        options, scene.filter,
        make_workers(plan_render(options, scene, infos), scene, infos, *bell), bell,
        std::move(hooks));
  }
};

Film whole_film(const ImageFilm& film) {
  Film whole = film.take(film.window);
  whole.tally = film.tally;
  return whole;
}

class DeviceGroup : public testing::TestWithParam<Settings> {};
INSTANTIATE_TEST_SUITE_P(
    Images, DeviceGroup,
    testing::Values(Settings{{"scene", "spheres"}, {"mode", "megakernel"}},
                    Settings{{"scene", "cornell"}, {"rng", "xorwow"}},
                    Settings{{"scene", "boxes"}, {"aov", "albedo,depth,primitive,variance,rays"}},
                    Settings{
                        {"scene", "instances:20"}, {"filter", "gaussian"}, {"sampler", "sobol"}},
                    Settings{{"scene", "boxes"}, {"filter", "mitchell"}, {"aov", "normal,bounces"}},
                    Settings{{"scene", "dial:16"}, {"crop", "3,5,30,27"}},
                    Settings{{"scene", "spheres"}, {"width", "1"}, {"height", "300"}}));

TEST_P(DeviceGroup, MakesTheImageOfOne) {
  const Options options = small(GetParam());
  const DeviceInfo device = choose_device(options.device);
  const SceneData scene = make_scene_for(options, device);
  const auto single = make_renderer(options, scene, device);
  Film expected;
  expected.window = window_of(options);
  single->render(expected, options.spp, {});
  const Image image = single->image();
  for (const int devices : {1, 2, 3, 7}) {
    Group group(options, scene, devices);
    std::uint64_t last = 0, total = 0;
    RenderHooks hooks;
    hooks.progress = [&](std::uint64_t done, std::uint64_t all) {
      EXPECT_GE(done, last);
      last = done, total = all;
    };
    const RenderRun run = group.renderer->render(hooks);
    EXPECT_EQ(run.samples_done, options.spp);
    EXPECT_EQ(run.ended_by, RunEnd::samples);
    EXPECT_EQ(last, total);
    EXPECT_EQ(total, expected.window.pixel_count() * 6);
    EXPECT_EQ(run.devices.size(), static_cast<std::size_t>(devices));
    std::uint64_t samples = 0;
    for (const DeviceShare& share : run.devices) samples += share.samples;
    EXPECT_EQ(samples, total);
    EXPECT_EQ(differing_sums(whole_film(group.renderer->film()), expected), 0u) << devices;
    const Image made = group.renderer->image();
    EXPECT_EQ(differing_pixels(made, image), 0u);
    EXPECT_EQ(made.place.x, static_cast<int>(expected.window.x));
    EXPECT_EQ(made.place.y, static_cast<int>(expected.window.y));
    EXPECT_EQ(made.place.width, options.width);
    EXPECT_EQ(made.place.height, options.height);
    ASSERT_EQ(made.layers.size(), image.layers.size());
    for (std::size_t i = 0; i < image.layers.size(); ++i) {
      EXPECT_EQ(made.layers[i].values, image.layers[i].values) << image.layers[i].name;
      EXPECT_EQ(made.layers[i].numbers, image.layers[i].numbers) << image.layers[i].name;
    }
    RenderReport report;
    group.renderer->describe(report);
    expect_same_counts(report.counts, summarize(expected.tally));
  }
}

TEST(GroupRenderer, StopsByErrorWhereOneDeviceDoes) {
  const Options options = small({{"scene", "cornell"}, {"spp", "5000"}});
  const DeviceInfo device = choose_device(options.device);
  RenderHooks hooks;
  hooks.stops.relative_error = 0.2;
  Options with_error = options;
  with_error.target_error = 0.2f;
  const SceneData scene = make_scene_for(with_error, device);
  const auto single = make_renderer(with_error, scene, device);
  const RenderRun expected = single->render(hooks);
  ASSERT_EQ(expected.ended_by, RunEnd::target_error);
  Group group(with_error, scene, 3);
  const RenderRun run = group.renderer->render(hooks);
  EXPECT_EQ(run.ended_by, RunEnd::target_error);
  EXPECT_EQ(run.samples_done, expected.samples_done);
  EXPECT_EQ(run.relative_error, expected.relative_error);
  EXPECT_EQ(differing_pixels(group.renderer->image(), single->image()), 0u);
}

TEST(GroupRenderer, ATimeLimitLeavesWholeSamples) {
  const Options options = small({{"scene", "cornell"}, {"spp", "1000000"}});
  const DeviceInfo device = choose_device(options.device);
  const SceneData scene = make_scene_for(options, device);
  Group group(options, scene, 2);
  RenderHooks hooks;
  hooks.stops.seconds = 0.3;
  const RenderRun run = group.renderer->render(hooks);
  EXPECT_EQ(run.ended_by, RunEnd::time_limit);
  EXPECT_GT(run.samples_done, 0);
  EXPECT_LT(run.samples_done, options.spp);
  const auto single = make_renderer(options, scene, device);
  Film expected;
  expected.window = window_of(options);
  single->render(expected, run.samples_done, {});
  EXPECT_EQ(differing_sums(whole_film(group.renderer->film()), expected), 0u);
}

// What an interruption leaves is gone on with by other devices, as often as one likes.
TEST(GroupRenderer, AnInterruptedFilmIsContinued) {
  const Options options =
      small({{"scene", "boxes"}, {"spp", "300"}, {"aov", "albedo,variance"}, {"threads", "1"}});
  const DeviceInfo device = choose_device(options.device);
  const SceneData scene = make_scene_for(options, device);
  const auto single = make_renderer(options, scene, device);
  Film expected;
  expected.window = window_of(options);
  single->render(expected, options.spp, {});
  ImageFilm film(window_of(options), FilmPlan{});
  int interruptions = 0;
  for (int devices = 1;; devices = devices % 3 + 1) {
    Group group(options, scene, devices);
    if (interruptions > 0) group.renderer->start_from(film);
    const double begin_s = static_cast<double>(std::clock());
    RenderHooks hooks;
    hooks.stop = [&] {
      return interruptions < 5 &&
             static_cast<double>(std::clock()) - begin_s > 0.05 * CLOCKS_PER_SEC;
    };
    const RenderRun run = group.renderer->render(hooks);
    film = group.renderer->film();
    if (run.ended_by == RunEnd::samples) break;
    ++interruptions;
    EXPECT_EQ(run.ended_by, RunEnd::interrupted);
    EXPECT_LT(film.samples(), expected.window.pixel_count() * 300);
  }
  EXPECT_GT(interruptions, 0);
  EXPECT_EQ(differing_sums(whole_film(film), expected), 0u);
  expect_same_counts(summarize(film.tally), summarize(expected.tally));
}

/// A worker without a device: `samples` more are so many more of each pixel. May fail.
class FakeWorker : public Worker {
 public:
  FakeWorker(int fails_at, bool sends_others = false)
      : fails_at_(fails_at), sends_others_(sends_others) {}

  std::string name() const override { return "fake"; }
  int capacity() const override { return 2; }
  std::uint64_t least_paths() const override { return 16; }
  void begin(Unit&& unit) override { units_.push_back(std::move(unit)); }
  std::optional<UnitResult> poll() override {
    if (units_.empty()) return std::nullopt;
    Unit unit = std::move(units_.front());
    units_.erase(units_.begin());
    UnitResult result{unit.id, std::move(unit.film), {}, 1.0, "", ""};
    if (fails_at_ > 0 && ++ended_ >= fails_at_) {
      if (sends_others_) {
        result.id += 1000;
      } else {
        result.error = "broke";
      }
      return result;
    }
    Film& film = result.film;
    if (film.is_empty()) {
      film.reset({}, film.window.pixel_count());
      film.parts = {film.window};
    }
    for (FilmPixel& pixel : film.pixels) {
      pixel.sum[0] += unit.samples;
      pixel.samples += static_cast<std::uint64_t>(unit.samples);
    }
    film.next_sample += static_cast<std::uint32_t>(unit.samples);
    result.run.samples_done = unit.samples;
    result.run.kernel_ms = 1;
    return result;
  }
  void cancel() override {}
  void describe(RenderReport& report) override { report.device_name = "fake"; }

 private:
  int fails_at_;
  bool sends_others_;
  int ended_ = 0;
  std::vector<Unit> units_;
};

TEST(GroupRenderer, OtherWorkersTakeTheUnitsOfOneThatFails) {
  const Options options = small({{"width", "300"}, {"height", "200"}, {"spp", "50"}});
  for (const bool sends_others : {false, true}) {
    GroupRenderer::Workers workers;
    workers.push_back(std::make_unique<FakeWorker>(0));
    workers.push_back(std::make_unique<FakeWorker>(3, sends_others));
    workers.push_back(std::make_unique<FakeWorker>(1, sends_others));
    std::vector<std::string> warnings;
    int grown = 0;
    GroupRenderer group(options, {}, std::move(workers), nullptr,
                        {[&](const ImageFilm&) { ++grown; },
                         [&](const std::string& text) { warnings.push_back(text); }});
    const RenderRun run = group.render(RenderHooks{});
    EXPECT_EQ(run.samples_done, 50);
    for (const FilmPixel& pixel : group.film().pixels) {
      ASSERT_EQ(pixel.samples, 50u);
      ASSERT_EQ(pixel.sum[0], 50.0);
    }
    ASSERT_EQ(warnings.size(), 2u);
    EXPECT_NE(warnings[0].find(sends_others ? "another unit" : "broke"), std::string::npos);
    EXPECT_GT(grown, 3);
    EXPECT_EQ(run.devices[2].units, 0u);
    EXPECT_EQ(run.devices[1].units, 2u);
  }
}

// Devices work at the same time: the longest of their times is the render's.
TEST(GroupRenderer, SamplesThatAreAddedAreThoseOfTheCall) {
  const Options options = small({{"width", "60"}, {"height", "40"}, {"spp", "50"}});
  GroupRenderer::Workers workers;
  for (int i = 0; i < 3; ++i) workers.push_back(std::make_unique<FakeWorker>(0));
  GroupRenderer group(options, {}, std::move(workers), nullptr);
  for (const int samples : {7, 1, 20}) {
    const RenderRun run = group.add(samples, {});
    EXPECT_EQ(run.samples_done, samples);
    double longest = 0, sum = 0;
    for (const DeviceShare& share : run.devices) {
      EXPECT_EQ(share.kernel_ms, static_cast<double>(share.units));
      longest = std::max(longest, share.kernel_ms), sum += share.kernel_ms;
    }
    EXPECT_EQ(run.kernel_ms, longest);
    EXPECT_LT(longest, sum);
  }
  EXPECT_EQ(group.film().least_samples(), 28u);
  EXPECT_EQ(group.render(RenderHooks{}).samples_done, 50);
  EXPECT_EQ(group.film().least_samples(), 50u) << "a render begins anew";
}

TEST(GroupRenderer, AWindowsFilmHasItsOwnTally) {
  const Options options = small({{"scene", "boxes"}});
  const DeviceInfo device = choose_device(options.device);
  const SceneData scene = make_scene_for(options, device);
  Film expected;
  expected.window = {5, 3, 20, 11};
  make_renderer(options, scene, device)->render(expected, 4, {});
  Group group(options, scene, 2);
  Film film;
  film.window = expected.window;
  group.renderer->render(film, 1, {});
  group.renderer->render(film, 3, {});
  EXPECT_EQ(film.next_sample, 4u);
  EXPECT_EQ(differing_sums(film, expected), 0u);
  expect_same_counts(summarize(film.tally), summarize(expected.tally));
}

/// With memory, kernels and a name of its own; breaks at once, or never.
class DescribedWorker : public FakeWorker {
 public:
  DescribedWorker(std::string device, std::vector<BufferSize> memory, bool breaks = false)
      : FakeWorker(breaks ? 1 : 0), device_(std::move(device)), memory_(std::move(memory)) {}
  void describe(RenderReport& report) override {
    report.device_name = device_;
    report.memory.insert(report.memory.end(), memory_.begin(), memory_.end());
  }

 private:
  std::string device_;
  std::vector<BufferSize> memory_;
};

/// As "name:bytes", in the order of the report.
std::string text_of(const std::vector<BufferSize>& memory) {
  std::string text;
  for (const BufferSize& b : memory) text += fmt::format("{}:{} ", b.name, b.size_bytes);
  return text;
}

// Devices that still work are named once each, in their order.
TEST(GroupRenderer, DescribesAllDevicesTogether) {
  struct Case {
    std::vector<std::tuple<std::string, std::vector<BufferSize>, bool>> devices;
    std::string name, memory;
  };
  const std::vector<BufferSize> pool{{"pool", 5}, {"scene", 1000}},
      large{{"scene", 3}, {"pool", 70}};
  const std::vector<Case> cases = {
      {{{"A", pool, false}}, "A", "pool:5 scene:1000 "},
      {{{"A", pool, false}, {"A", pool, false}}, "2 x A", "pool:10 scene:2000 "},
      {{{"A", pool, false}, {"B", large, false}}, "A, B", "scene:1003 pool:75 "},
      {{{"A", pool, false}, {"A", pool, false}, {"A", large, false}},
       "3 x A",
       "scene:2003 pool:80 "},
      {{{"A", pool, false}, {"B", {{"film", 9}}, false}}, "A, B", "film:9 pool:5 scene:1000 "},
      {{{"A", pool, false}, {"B", large, true}}, "A", "pool:5 scene:1000 "},
      {{{"B", large, true}, {"A", pool, false}, {"C", {}, false}}, "A, C", "pool:5 scene:1000 "}};
  const Options options = small({{"width", "60"}, {"height", "40"}, {"spp", "8"}});
  for (const Case& c : cases) {
    GroupRenderer::Workers workers;
    for (const auto& [name, memory, breaks] : c.devices) {
      workers.push_back(std::make_unique<DescribedWorker>(name, memory, breaks));
    }
    GroupRenderer group(options, {}, std::move(workers), nullptr,
                        {[](const ImageFilm&) {}, [](const std::string&) {}});
    group.render(RenderHooks{});
    RenderReport report;
    group.describe(report);
    EXPECT_EQ(report.device_name, c.name);
    EXPECT_EQ(text_of(report.memory), c.memory) << c.name;
  }
}

/// Takes longer to be reached than to compute: 1e5 paths per second, 2 s for each unit.
class FarWorker : public FakeWorker {
 public:
  FarWorker() : FakeWorker(0) {}
  std::optional<UnitResult> poll() override {
    std::optional<UnitResult> result = FakeWorker::poll();
    if (!result) return result;
    const auto pixels = static_cast<double>(result->film.window.pixel_count());
    result->run.kernel_ms = 1e3 * pixels * result->run.samples_done / 1e5;
    result->wall_ms = result->run.kernel_ms + 2000;
    return result;
  }
};

TEST(GroupRenderer, UnitsDoNotShrinkForTheirOverhead) {
  const Options options = small({{"width", "40"}, {"height", "30"}, {"spp", "20000"}});
  GroupRenderer::Workers workers;
  for (int i = 0; i < 2; ++i) workers.push_back(std::make_unique<FarWorker>());
  GroupRenderer group(options, {}, std::move(workers), nullptr);
  const RenderRun run = group.render(RenderHooks{});
  // 240 s of work, in units of about one second of the largest window.
  EXPECT_GT(run.devices[0].units + run.devices[1].units, 240u);
  EXPECT_LT(run.devices[0].units + run.devices[1].units, 3000u);
}

/// Has a speed in paths per second.
class TimedWorker : public FakeWorker {
 public:
  explicit TimedWorker(double speed, int fails_at = 0) : FakeWorker(fails_at), speed_(speed) {}
  std::optional<UnitResult> poll() override {
    std::optional<UnitResult> result = FakeWorker::poll();
    if (!result || !result->error.empty()) return result;
    const auto pixels = static_cast<double>(result->film.window.pixel_count());
    result->run.kernel_ms = 1e3 * pixels * result->run.samples_done / speed_;
    return result;
  }

 private:
  double speed_;
};

// The image grows evenly until 20 s of work are left for those that still work: 2e6 paths.
TEST(GroupRenderer, AFailedDevicesSpeedIsForgotten) {
  const Options options = small({{"width", "40"}, {"height", "30"}, {"spp", "20000"}});
  GroupRenderer::Workers workers;
  workers.push_back(std::make_unique<TimedWorker>(1e5));
  workers.push_back(std::make_unique<TimedWorker>(1e9, 2));
  std::uint32_t widest = 0;
  const std::vector<Window> image{window_of(options)};
  const auto look = [&](const ImageFilm& film) {
    if (film.samples() > 20000u * 1200 - 3'000'000) return;
    std::uint32_t most = 0;
    for (const FilmPart& part : film.parts) most = std::max(most, part.next_sample);
    widest = std::max(widest, most - film.least_samples(image));
  };
  GroupRenderer group(options, {}, std::move(workers), nullptr, {look, [](const std::string&) {}});
  EXPECT_EQ(group.render(RenderHooks{}).samples_done, 20000);
  EXPECT_GT(widest, 0u);
  EXPECT_LT(widest, 3000u);  // units are of some 600 samples
}

/// Its first render goes on until it is stopped.
class PatientRenderer : public Renderer {
 public:
  explicit PatientRenderer(std::promise<void>& has_begun) : has_begun_(has_begun) {}
  RenderRun render(const RenderHooks&) override { return {}; }
  RenderRun render(Film&, int samples, const RenderHooks& hooks) override {
    if (std::exchange(is_first_, false)) {
      has_begun_.set_value();
      while (!hooks.stop()) std::this_thread::yield();
    }
    RenderRun run;
    run.samples_done = hooks.stop() ? 0 : samples;
    return run;
  }
  RenderRun add(int, const RenderHooks&) override { return {}; }
  Image image() override { return {}; }
  void describe(RenderReport&) const override {}

 private:
  std::promise<void>& has_begun_;
  bool is_first_ = true;
};

TEST(LocalWorker, AnInterruptionEndsWithItsUnits) {
  ResultBell bell;
  std::promise<void> has_begun;
  LocalWorker worker(
      "w", 1, [&](int) { return std::make_unique<PatientRenderer>(has_begun); }, bell);
  const auto result = [&] {
    for (;;) {
      if (const auto found = worker.poll()) return *found;
      bell.wait(0.02);
    }
  };
  worker.begin({1, {}, 5});
  has_begun.get_future().wait();
  worker.cancel();
  EXPECT_EQ(result().run.samples_done, 0);
  for (const std::uint64_t id : {2u, 3u}) {
    worker.begin({id, {}, 5});
    EXPECT_EQ(result().run.samples_done, 5) << id;
    worker.cancel();  // has nothing to do
  }
}

TEST(GroupRenderer, SaysSoWhereNoWorkerIsLeft) {
  const Options options = small({{"width", "300"}, {"height", "200"}, {"spp", "50"}});
  GroupRenderer::Workers workers;
  workers.push_back(std::make_unique<FakeWorker>(2));
  workers.push_back(std::make_unique<FakeWorker>(3));
  GroupRenderer group(options, {}, std::move(workers), nullptr);
  EXPECT_EQ(error_of([&] { group.render(RenderHooks{}); }).find("fake: broke"), 0u);
  EXPECT_GT(group.film().samples(), 0u);  // and what was done is there
}

TEST(GroupRenderer, ThrowsWhatMakingARendererThrows) {
  ResultBell bell;
  LocalWorker worker(
      "w", 1, [](int) -> std::unique_ptr<Renderer> { throw Error("no memory"); }, bell);
  EXPECT_EQ(error_of([&] { worker.wait_until_ready(); }), "no memory");
}

/// Runs out of memory `times` times in renders, each after it has begun to change a copy.
class HungryRenderer : public Renderer {
 public:
  HungryRenderer(std::unique_ptr<Renderer> renderer, int& times)
      : renderer_(std::move(renderer)), times_(times) {}

  RenderRun render(const RenderHooks& hooks) override { return renderer_->render(hooks); }
  RenderRun render(Film& film, int samples, const RenderHooks& hooks) override {
    if (times_-- > 0) throw OutOfMemory("no room for a stack");
    return renderer_->render(film, samples, hooks);
  }
  RenderRun add(int samples, const RenderHooks& hooks) override {
    return renderer_->add(samples, hooks);
  }
  Image image() override { return renderer_->image(); }
  void describe(RenderReport& report) const override { renderer_->describe(report); }

 private:
  std::unique_ptr<Renderer> renderer_;
  int& times_;
};

struct Hungry {
  std::vector<int> halvings;
  std::vector<std::string> warnings;
  Film film;

  /// One device, whose memory is too little so often when it is set up, and in renders.
  Hungry(const Options& options, int at_setup, int in_renders) {
    const DeviceInfo device = choose_device(options.device);
    const SceneData scene = make_scene_for(options, device);
    ResultBell bell;
    GroupRenderer::Workers workers;
    workers.push_back(std::make_unique<LocalWorker>(
        "w", 4096,
        [&](int share) -> std::unique_ptr<Renderer> {
          halvings.push_back(share);
          if (at_setup-- > 0) throw OutOfMemory("no room for a pool");
          return std::make_unique<HungryRenderer>(make_renderer(options, scene, device),
                                                  in_renders);
        },
        bell));
    GroupRenderer group(options, scene.filter, std::move(workers), nullptr,
                        {{}, [&](const std::string& text) { warnings.push_back(text); }});
    group.render(RenderHooks{});
    film = whole_film(group.film());
  }
};

TEST(GroupRenderer, ADeviceThatRunsOutOfMemoryTakesLess) {
  const Options options = small();
  const Hungry fed(options, 0, 0), at_setup(options, 2, 0), in_renders(options, 0, 3),
      both(options, 1, 1);
  EXPECT_EQ(fed.halvings, (std::vector<int>{0}));
  EXPECT_TRUE(fed.warnings.empty());
  EXPECT_EQ(at_setup.halvings, (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(in_renders.halvings, (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(both.halvings, (std::vector<int>{0, 1, 2}));
  for (const Hungry* hungry : {&at_setup, &in_renders, &both}) {
    ASSERT_EQ(hungry->warnings.size(), 1u);
    EXPECT_NE(hungry->warnings[0].find("goes on with less memory"), std::string::npos);
    EXPECT_EQ(differing_sums(hungry->film, fed.film), 0u);
  }
}

TEST(GroupRenderer, LittleMemoryIsAnErrorInTheEnd) {
  const Options options = small();
  EXPECT_NE(error_of([&] { Hungry(options, 100, 0); }).find("no room for a pool"),
            std::string::npos);
  EXPECT_NE(error_of([&] { Hungry(options, 0, 100); }).find("no room for a stack"),
            std::string::npos);
}

TEST(Parts, AreDisjointAndTheWhole) {
  for (const char* crop : {"", "3,5,70,99"}) {
    for (const int count : {1, 2, 3, 16, 90}) {
      Options options = small({{"width", "80"}, {"height", "100"}});
      if (*crop != '\0') apply(options, {{"crop", crop}});
      const Window image = window_of(options);
      std::set<std::pair<std::uint32_t, std::uint32_t>> pixels;
      for (int i = 1; i <= count; ++i) {
        options.part = {i, count};
        std::uint64_t own = 0;
        for (const Window& w : part_windows(options)) {
          EXPECT_TRUE(image.contains(w));
          own += w.pixel_count();
          for (std::uint32_t y = w.y; y < w.y + w.height; ++y)
            for (std::uint32_t x = w.x; x < w.x + w.width; ++x)
              EXPECT_TRUE(pixels.insert({x, y}).second);
        }
        EXPECT_GT(own, 0u);
      }
      EXPECT_EQ(pixels.size(), image.pixel_count());
    }
  }
  Options options = small();
  options.part = {1, 30};
  EXPECT_THROW(part_windows(options), Error);  // 29 rows
  options.part = {29, 29};
  EXPECT_EQ(part_windows(options).size(), 1u);
}

// Units are as large as a device needs to be busy.
TEST(Parts, WorkersOfMoreThreadsWantMorePaths) {
  const Options options = small();
  std::vector<DeviceInfo> devices(2, choose_device(options.device));
  devices[0].properties.threads = 1, devices[1].properties.threads = 3;
  const SceneData scene = make_scene_for(options, devices[0]);
  ResultBell bell;
  const auto workers = make_workers(plan_render(options, scene, devices), scene, devices, bell);
  EXPECT_EQ(workers[0]->least_paths(), 4096u);
  EXPECT_EQ(workers[1]->least_paths(), 3u * 4096);
}

}  // namespace
}  // namespace pt
