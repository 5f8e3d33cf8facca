// A render that somebody watches: its images are those of a render at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "common/platform/steady_seconds.h"
#include "common/scene/prepare/prepare_steps.h"
#include "render_words.h"
#include "view/live_render.h"

namespace {

using namespace pt;

using Words = OptionWords;

constexpr double patience_s = 120;  // a machine may be busy

/// Ends the program if a test hangs, which no expectation would see.
class Watch {
 public:
  Watch() = default;
  ~Watch() {
    {
      const std::lock_guard lock(mutex_);
      is_over_ = true;
    }
    over_.notify_all();
    thread_.join();
  }

 private:
  std::mutex mutex_;
  std::condition_variable over_;
  bool is_over_ = false;
  std::thread thread_{[this] {
    std::unique_lock lock(mutex_);
    const auto limit = std::chrono::duration<double>(3 * patience_s);
    if (over_.wait_for(lock, limit, [&] { return is_over_; })) return;
    std::fputs("a LiveRender hangs\n", stderr);
    std::abort();
  }};
};

struct WatchedRender : private Watch, public LiveRender {
  using LiveRender::LiveRender;
};

std::vector<Setting> settings_of(const Words& more = {}) {
  return settings_from({{"scene", "cornell"},
                        {"output", "page.png"},
                        {"width", "32"},
                        {"height", "24"},
                        {"device", "cpu"},
                        {"spp", "13"}},
                       more);
}

/// What a session of its own renders at once, through a camera that was moved.
Image rendered(const Words& more, const Orbit& orbit = {}) {
  const RenderCommand command = make_render_command(settings_of(more));
  RenderSession session(command, {});
  if (orbit != Orbit()) session.change_camera() = orbit_camera(session.scene().camera, orbit);
  return render_now(session, command).image;
}

template <class Holds>
LiveState wait_until(const LiveRender& live, Holds holds) {
  const double begin_s = steady_seconds();
  LiveState state = live.state();
  while (!holds(state) && steady_seconds() - begin_s < patience_s)
    state = live.wait(state.version, 0.1);
  EXPECT_TRUE(holds(state)) << "waited in vain";
  return state;
}

bool is_done(const LiveState& state) { return state.status == LiveStatus::done; }

void expect_same(const Image& a, const Image& b) {
  ASSERT_EQ(a.width, b.width);
  ASSERT_EQ(a.height, b.height);
  EXPECT_EQ(differing_pixels(a, b), 0u);
}

TEST(NextPass, DoublesTheSamplesWithinItsTime) {
  EXPECT_EQ(next_pass(0, 100, 0), 1);
  EXPECT_EQ(next_pass(1, 100, 1), 1);
  EXPECT_EQ(next_pass(2, 100, 1), 2);
  EXPECT_EQ(next_pass(32, 100, 1), 32);
  EXPECT_EQ(next_pass(64, 100, 1), 36) << "no more than is wanted";
  EXPECT_EQ(next_pass(64, 1000, 10), 20) << "a fifth of a second";
  EXPECT_EQ(next_pass(64, 1000, 5000), 1) << "nor less than one";
}

TEST(LiveRender, HasTheBitsOfARenderAtOnce) {
  for (const char* const mode : {"serial", "megakernel", "wavefront"}) {
    WatchedRender live(settings_of({{"mode", mode}}), {});
    live.set_watched(true);
    const LiveState state = wait_until(live, is_done);
    ASSERT_EQ(state.views.size(), 1u);
    EXPECT_EQ(state.views.front().samples, 13);
    expect_same(*state.views.front().image, rendered({{"mode", mode}}));
  }
}

TEST(LiveRender, KeepsTheCamerasOptions) {
  const Words words{{"look-from", "250,250,-700"}, {"fov", "50"}};
  WatchedRender live(settings_of(words), {});
  live.set_watched(true);
  expect_same(*wait_until(live, is_done).views.front().image, rendered(words));
}

// The page moves the camera that the options place.
TEST(LiveRender, MovesACameraOfOptions) {
  const Words words{{"look-from", "250,250,-700"}, {"fov", "50"}};
  WatchedRender live(settings_of(words), {});
  const LiveSettings moved{live.state().settings.modes, {20, 5, 0.9}};
  live.change(moved);
  live.set_watched(true);
  const RenderCommand plain = make_render_command(settings_of());
  RenderSession session(plain, {});
  CameraParameters camera = session.scene().camera;
  override_camera(camera, make_render_command(settings_of(words)).options.camera);
  session.change_camera() = orbit_camera(camera, moved.orbit);
  MeasureHooks hooks;
  hooks.stop = [] { return false; };
  expect_same(*wait_until(live, is_done).views.front().image,
              session.render(plain, hooks, {}).image);
}

TEST(LiveRender, BeginsAnewWhereTheCameraMoves) {
  WatchedRender live(settings_of(), {});
  live.set_watched(true);
  wait_until(live, is_done);
  const LiveSettings moved{live.state().settings.modes, {30, 10, 0.8}};
  live.change(moved);
  const LiveState begun = live.state();
  EXPECT_LT(begun.views.front().samples, 13);
  const LiveState state = wait_until(live, is_done);
  expect_same(*state.views.front().image, rendered({}, moved.orbit));
  live.change({moved.modes, {}});  // back to rest, by a camera that has moved
  expect_same(*wait_until(live, is_done).views.front().image, rendered({}));
}

TEST(LiveRender, OnlyTheLastOfManyCamerasIsFinished) {
  WatchedRender live(settings_of(), {});
  live.set_watched(true);
  const std::vector<Mode> modes = live.state().settings.modes;
  for (int i = 1; i <= 40; ++i) live.change({modes, {i * 2.0, 0, 1}});
  expect_same(*wait_until(live, is_done).views.front().image, rendered({}, {80, 0, 1}));
}

/// A change every 10 ms is faster than a pass of this size.
TEST(LiveRender, ShowsImagesWhileTheCameraMoves) {
  WatchedRender live(settings_of({{"width", "320"}, {"height", "240"}, {"mode", "serial"}}), {});
  live.set_watched(true);
  const std::vector<Mode> modes = live.state().settings.modes;
  const auto images = [&] { return live.state().views.front().image_number; };
  wait_until(live, [](const LiveState& state) { return state.views.front().image_number > 0; });
  std::uint64_t last = images();
  int seen = 0;
  const double begin_s = steady_seconds();
  for (int i = 1; seen < 3 && steady_seconds() - begin_s < patience_s / 4; ++i) {
    live.change({modes, {i * 0.5, 0, 1}});
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    if (images() == last) continue;
    last = images();
    ++seen;
  }
  EXPECT_EQ(seen, 3) << "images while the camera moves";
}

TEST(LiveRender, TwoModesShowImagesByTurnsWhileTheCameraMoves) {
  WatchedRender live(settings_of({{"width", "320"}, {"height", "240"}}), {});
  const std::vector<Mode> modes{Mode::serial, Mode::wavefront};
  live.change({modes, {}});
  live.set_watched(true);
  std::uint64_t last[2] = {};
  int seen[2] = {};
  const double begin_s = steady_seconds();
  for (int i = 1; std::min(seen[0], seen[1]) < 2; ++i) {
    live.change({modes, {i * 0.5, 0, 1}});
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    const LiveState state = live.state();
    for (std::size_t k = 0; k < 2; ++k) {
      if (state.views[k].image_number == last[k]) continue;
      last[k] = state.views[k].image_number;
      ++seen[k];
    }
    ASSERT_LT(steady_seconds() - begin_s, patience_s / 4)
        << seen[0] << " and " << seen[1] << " images while the camera moves";
  }
}

TEST(LiveRender, MeasuresItsPasses) {
  WatchedRender live(settings_of(), {});
  EXPECT_EQ(live.state().views.front().msamples_per_s, 0);
  live.set_watched(true);
  const LiveView view = wait_until(live, is_done).views.front();
  EXPECT_EQ(view.pass_samples, 5) << "of 13: 1, 1, 2, 4, 5";
  EXPECT_GT(view.pass_ms, 0);
  EXPECT_LT(view.pass_ms, 1e3 * patience_s);
  EXPECT_DOUBLE_EQ(view.msamples_per_s, 32 * 24 * view.pass_samples / view.pass_ms / 1e3);
}

TEST(LiveRender, RendersNothingWhileNobodyWatches) {
  WatchedRender live(settings_of({{"spp", "1000000"}}), {});
  EXPECT_EQ(live.wait(live.state().version, 0.3).status, LiveStatus::idle);
  EXPECT_EQ(live.state().views.front().samples, 0);
  live.set_watched(true);
  wait_until(live, [](const LiveState& state) { return state.views.front().samples > 2; });
  live.set_watched(false);
  live.wait(live.state().version, 0.3);  // the pass that was at work
  const LiveState idle = live.state();
  EXPECT_EQ(idle.status, LiveStatus::idle);
  EXPECT_EQ(live.wait(idle.version, 0.3).version, idle.version);
  live.set_watched(true);
  wait_until(live, [&](const LiveState& state) {
    return state.views.front().samples > idle.views.front().samples;
  });
}

TEST(LiveRender, APauseLeavesNoTraceInTheImage) {
  WatchedRender live(settings_of({{"spp", "60"}}), {});
  for (int ms = 1; !is_done(live.state()); ++ms) {  // longer each time, so that it ends
    live.set_watched(true);
    std::this_thread::sleep_for(std::chrono::milliseconds(ms));
    live.set_watched(false);
    if (ms % 2 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  expect_same(*live.state().views.front().image, rendered({{"spp", "60"}}));
}

TEST(LiveRender, TwoModesRenderTheSameImageByTurns) {
  WatchedRender live(settings_of(), {});
  live.change({{Mode::wavefront, Mode::megakernel}, {}});
  std::atomic<bool> ends{false};
  int furthest = 0;
  std::thread watcher([&] {  // by passes that double, one view has twice the other's at most
    LiveState state = live.state();
    while (!ends) {
      state = live.wait(state.version, 0.05);
      const int a = state.views.front().samples, b = state.views.back().samples;
      if (std::min(a, b) > 0) furthest = std::max(furthest, std::max(a, b) / std::min(a, b));
    }
  });
  live.set_watched(true);
  const LiveState state = wait_until(live, is_done);
  ends = true;
  watcher.join();
  EXPECT_LE(furthest, 2);
  ASSERT_EQ(state.views.size(), 2u);
  EXPECT_EQ(state.views.front().mode, Mode::wavefront);
  EXPECT_EQ(state.views.back().mode, Mode::megakernel);
  for (const LiveView& view : state.views) {
    EXPECT_EQ(view.samples, 13);
    expect_same(*view.image, rendered({}));
  }
}

// While the page waits for the first pass of other settings.
TEST(LiveRender, KeepsTheImagesOfModesThatStay) {
  WatchedRender live(settings_of({{"mode", "wavefront"}}), {});
  live.set_watched(true);
  const LiveState before = wait_until(live, is_done);
  live.set_watched(false);
  live.change({{Mode::serial, Mode::wavefront}, {20, 5, 1}});
  const LiveState after = live.state();
  ASSERT_EQ(after.views.size(), 2u);
  EXPECT_EQ(after.views.front().image, nullptr);
  EXPECT_EQ(after.views.back().image, before.views.front().image);
  EXPECT_EQ(after.views.back().samples, 0);
}

TEST(LiveRender, TakesOptionsOfOneModeInAll) {
  const Words words{{"mode", "wavefront"}, {"pool-size", "1000"}};
  WatchedRender live(settings_of(words), {});
  live.set_watched(true);
  live.change({{Mode::serial}, {}});
  expect_same(*wait_until(live, is_done).views.front().image, rendered({}));
}

TEST(LiveRender, AnotherExposureRendersNothing) {
  WatchedRender live(settings_of({{"exposure", "1.5"}}), {});
  EXPECT_EQ(live.state().display.exposure, 1.5f);
  live.set_watched(true);
  const LiveState before = wait_until(live, is_done);
  SettingsChange darker;
  darker.exposure = -2.0f, darker.curve = ToneCurve::aces;
  live.change_display(darker);
  const LiveState after = live.state();
  EXPECT_EQ(after.display, (Display{"color", -2, ToneCurve::aces}));
  EXPECT_NE(after.version, before.version);
  EXPECT_EQ(after.views.front().image_number, before.views.front().image_number);
}

TEST(LiveRender, SaysWhatCannotBeRendered) {
  EXPECT_THROW(LiveRender(settings_of({{"scene", "no-such-scene"}}), {}), Error);
  EXPECT_THROW(LiveRender(settings_of({{"look-from", "1,1,1"}, {"look-at", "1,1,1"}}), {}), Error);
  WatchedRender live(settings_of({{"device", "cpu:2"}}), {});  // serial has one
  live.set_watched(true);
  live.change({{Mode::serial}, {}});
  const LiveState failed =
      wait_until(live, [](const LiveState& state) { return state.status == LiveStatus::failed; });
  ASSERT_EQ(failed.status, LiveStatus::failed);
  EXPECT_NE(failed.error.find("--mode serial"), std::string::npos) << failed.error;
  live.change({{Mode::wavefront}, {}});
  expect_same(*wait_until(live, is_done).views.front().image, rendered({}));
}

TEST(LiveRender, EndsAtOnceAndAnswersWhoWaits) {
  WatchedRender live(settings_of({{"spp", "1000000"}}), {});
  live.set_watched(true);
  std::thread waiter([&] {
    for (std::uint64_t version = 0, i = 0; i < 3; ++i) version = live.wait(version, 1).version;
  });
  live.end();
  waiter.join();
}

TEST(LiveRender, APausedOneRendersNothingAndGoesOn) {
  WatchedRender live(settings_of({{"spp", "1000000"}}), {});
  live.set_watched(true);
  wait_until(live, [](const LiveState& state) { return state.views.front().samples > 2; });
  live.set_paused(true);
  EXPECT_EQ(live.state().status, LiveStatus::paused);
  live.wait(live.state().version, 0.3);  // the pass that was at work
  const LiveState paused = live.state();
  EXPECT_EQ(live.wait(paused.version, 0.3).version, paused.version);
  live.change({paused.settings.modes, {10, 0, 1}});  // waits as well
  EXPECT_EQ(live.wait(live.state().version, 0.3).views.front().samples, 0);
  live.set_paused(false);
  wait_until(live, [](const LiveState& state) { return state.views.front().samples > 2; });
}

TEST(LiveRender, MoreSamplesAreAddedToThoseThatAreThere) {
  for (const char* const sampler : {"independent", "stratified"}) {
    WatchedRender live(settings_of({{"spp", "5"}, {"sampler", sampler}}), {});
    live.set_watched(true);
    const LiveState before = wait_until(live, is_done);
    live.change_samples(21);
    const LiveState begun = live.state();
    EXPECT_EQ(begun.spp, 21);
    if (sampler == std::string("independent")) {
      EXPECT_GE(begun.views.front().samples, 5);
    } else {
      EXPECT_LT(begun.views.front().samples, 21) << "strata of other samples";
    }
    const LiveState state = wait_until(live, is_done);
    EXPECT_EQ(state.views.front().samples, 21);
    expect_same(*state.views.front().image, rendered({{"spp", "21"}, {"sampler", sampler}}));
  }
}

TEST(LiveRender, HasTheSizeAndScaleThatAreChosen) {
  WatchedRender live(settings_of({{"crop", "8,6,24,18"}}), {});
  EXPECT_EQ(live.state().settings.size, (ImageSize{32, 24}));
  live.set_watched(true);
  wait_until(live, is_done);
  LiveSettings settings = live.state().settings;
  settings.size = {80, 40}, settings.scale = 0.5;
  live.change(settings);
  const Words smaller{{"width", "40"}, {"height", "20"}, {"crop", "10,5,30,15"}};
  expect_same(*wait_until(live, is_done).views.front().image, rendered(smaller));
  settings.scale = 2;
  live.change(settings);
  const Image image = *wait_until(live, is_done).views.front().image;
  EXPECT_EQ(image.width, 80);
  EXPECT_EQ(image.height, 40);
}

TEST(LiveRender, RendersALayerWhereItIsLookedAt) {
  WatchedRender live(settings_of(), {});
  live.set_watched(true);
  const LiveState before = wait_until(live, is_done);
  const auto choose = [&](const char* layer) {
    SettingsChange change;
    change.layer = layer;
    live.change_display(change);
    return wait_until(live, is_done).views.front();
  };
  EXPECT_EQ(choose("rays").image, before.views.front().image) << "it has that one already";
  const LiveView depth = choose("depth");
  expect_same(*depth.image, *before.views.front().image);
  const auto& layers = depth.image->layers;
  const auto found = std::ranges::find(layers, "depth", &ImageLayer::name);
  ASSERT_NE(found, layers.end());
  const Image expected = rendered({{"output", "page.exr"}, {"aov", "depth"}});
  EXPECT_EQ(found->values, expected.layers.front().values);
  EXPECT_EQ(choose("color").image, depth.image) << "and keeps it";
}

TEST(LiveRender, ALayerThatCannotBeRenderedIsAnErrorUntilAnotherIsChosen) {
  WatchedRender live(settings_of({{"rng", "xorwow"}}), {});
  live.set_watched(true);
  wait_until(live, is_done);
  SettingsChange change;
  change.layer = "depth";
  live.change_display(change);
  const auto has_failed = [](const LiveState& s) { return s.status == LiveStatus::failed; };
  EXPECT_NE(wait_until(live, has_failed).error.find("--rng"), std::string::npos);
  change.layer = "color";
  live.change_display(change);
  expect_same(*wait_until(live, is_done).views.front().image, rendered({{"rng", "xorwow"}}));
}

// Against a scene that was loaded with the other values.
TEST(LiveRender, EditsMaterialsAndLights) {
  WatchedRender live(settings_of(), {});
  const auto& parameters = live.parameters();
  const auto find = [&](const std::string& end) {
    return std::ranges::find_if(
        parameters, [&](const LiveParameter& one) { return one.parameter.name.ends_with(end); });
  };
  ASSERT_NE(find("albedo"), parameters.end());
  const std::string albedo = find("albedo")->parameter.name;
  const std::string lamp = find("_3.radiance")->parameter.name;
  live.set_watched(true);
  wait_until(live, is_done);
  LiveSettings settings = live.state().settings;
  settings.parameters = {{albedo, {0.1f, 0.2f, 0.9f}}, {lamp, {3, 4, 5}}};
  live.change(settings);
  const LiveState edited = wait_until(live, is_done);
  const RenderCommand command = make_render_command(settings_of());
  RenderSession session(command, {});
  constexpr SceneChanges changes{.shading = true, .lights = true};
  session.change_scene(changes, [](SceneData& scene) {
    scene.materials[0][&Diffuse::albedo].value = {0.1f, 0.2f, 0.9f};
    scene.materials[3].emission.radiance = {3, 4, 5};
  });
  MeasureHooks hooks;
  hooks.stop = [] { return false; };
  expect_same(*edited.views.front().image, session.render(command, hooks, {}).image);
  settings.parameters.erase(albedo);  // one is reset; a mode joins
  settings.modes = {Mode::serial, Mode::wavefront};
  live.change(settings);
  session.change_scene(
      changes, [](SceneData& scene) { scene.materials[0][&Diffuse::albedo].value = Color(0.73f); });
  const LiveState state = wait_until(live, is_done);
  for (const LiveView& view : state.views)
    expect_same(*view.image, session.render(command, hooks, {}).image);
  settings.parameters = {{lamp, find("_3.radiance")->value}};  // as it was
  live.change(settings);
  EXPECT_TRUE(live.state().settings.parameters.empty());
  expect_same(*wait_until(live, is_done).views.front().image, rendered({}));
}

TEST(LiveRender, RefusesParametersAndChangesNothing) {
  LiveRender live(settings_of(), {});
  const LiveState before = live.state();
  const auto refused = [&](const std::string& name, std::vector<float> values) {
    LiveSettings settings = before.settings;
    settings.orbit.yaw = 10;
    settings.parameters[name] = std::move(values);
    try {
      live.change(settings);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refused("materials.nothing.albedo", {1}),
            "\"materials.nothing.albedo\": no such parameter of a material or light");
  EXPECT_NE(refused("camera.fov", {40}), "") << "the orbit is the camera's";
  const std::string& name = live.parameters().front().parameter.name;
  EXPECT_EQ(refused(name, {1}), "\"" + name + "\": expected 3 numbers");
  const LiveParameter& lamp = *std::ranges::find_if(
      live.parameters(), [](const auto& one) { return one.parameter.name.ends_with("radiance"); });
  EXPECT_NE(refused(lamp.parameter.name, {1, -1, 1}).find("0 or more"), std::string::npos);
  EXPECT_EQ(live.state().version, before.version);
  EXPECT_EQ(live.state().settings, before.settings);
}

TEST(LiveRender, ListsNoMoreMaterialsThanAPageCanShow) {
  const auto parameters = [](const char* spheres) {
    const LiveRender live(settings_of({{"scene", "spheres"}, {"spheres", spheres}}), {});
    return live.parameters().size();
  };
  EXPECT_GT(parameters("4000"), 8000u);
  EXPECT_EQ(parameters("4096"), 2u) << "with that of the ground one too many; the sky's two";
}

// Half the error for four times the samples, and as the program estimates it.
TEST(LiveRender, EstimatesItsError) {
  WatchedRender live(settings_of({{"spp", "64"}}), {});
  EXPECT_FALSE(live.state().views.front().relative_error);
  live.set_watched(true);
  const double error = wait_until(live, is_done).views.front().relative_error.value_or(0);
  const RenderCommand command =
      make_render_command(settings_of({{"spp", "64"}, {"target-error", "1e-6"}}));
  RenderSession session(command, {});
  MeasureHooks hooks;
  hooks.stop = [] { return false; };
  const RenderResult result = session.render(command, hooks, {});
  // That one is of the last of the numbers at which it is asked, below 64.
  EXPECT_NEAR(error, result.report.runs.back().relative_error.value_or(0), 0.15 * error);
  live.change_samples(256);
  EXPECT_NEAR(wait_until(live, is_done).views.front().relative_error.value_or(0), error / 2,
              0.15 * error);
}

TEST(LiveRender, AddsUpTheStagesOfAllPasses) {
  WatchedRender live(settings_of({{"mode", "wavefront"}, {"spp", "40"}}), {});
  live.set_watched(true);
  const LiveView view = wait_until(live, is_done).views.front();
  double sum = 0;
  for (const StageTime& stage : view.stages) sum += stage.time_ms;
  EXPECT_GT(view.kernel_ms, view.pass_ms) << "more than the last pass";
  EXPECT_LE(sum, view.kernel_ms * 1.01);
  EXPECT_GT(sum, view.kernel_ms * 0.1);
  EXPECT_LE(view.kernel_ms, view.wall_ms * 1.01);
  EXPECT_GT(view.stages.size(), 2u);
  EXPECT_EQ(view.decision.value, "wavefront");
  live.change({{Mode::wavefront}, {3, 0, 1}});
  EXPECT_TRUE(live.state().views.front().samples > 0 || live.state().views.front().wall_ms == 0);
}

TEST(LiveRender, SaysWhichModeAutoIs) {
  WatchedRender live(settings_of({{"mode", "auto"}}), {});
  live.set_watched(true);
  const Decision decision = wait_until(live, is_done).views.front().decision;
  RenderSession session(make_render_command(settings_of()), {});
  const std::vector<Decision> plan = session.plan(make_render_command(settings_of()));
  EXPECT_NE(std::ranges::find(plan, decision), plan.end());
  EXPECT_EQ(decision.option, "mode");
  EXPECT_NE(decision.value, "auto");
  EXPECT_FALSE(decision.reason.empty());
}

TEST(LiveRender, ComparesTwoModesOverRounds) {
  WatchedRender live(settings_of({{"spp", "400"}}), {});
  live.change({{Mode::serial, Mode::wavefront}, {}});
  live.set_watched(true);
  const LiveState state = wait_until(live, is_done);
  ASSERT_TRUE(state.ratio);
  EXPECT_GE(state.ratio->rounds, rounds_min);
  EXPECT_LE(state.ratio->low, state.ratio->value);
  EXPECT_GE(state.ratio->high, state.ratio->value);
  const double of_all = state.views[0].kernel_ms / state.views[1].kernel_ms;
  EXPECT_NEAR(state.ratio->value, of_all, 0.3 * of_all) << "the first round apart";
  live.change({{Mode::serial}, {}});
  EXPECT_FALSE(live.state().ratio);
}

TEST(TimeRatio, IsOfTheSumsAndItsIntervalOfTheRounds) {
  const std::vector<Round> equal(6, Round{3, 2});
  EXPECT_FALSE(time_ratio(std::span(equal).first(rounds_min - 1)));
  const TimeRatio exact = time_ratio(equal).value();
  EXPECT_EQ(exact.rounds, 6u);
  EXPECT_DOUBLE_EQ(exact.value, 1.5);
  EXPECT_DOUBLE_EQ(exact.low, 1.5);
  EXPECT_DOUBLE_EQ(exact.high, 1.5);
  std::vector<Round> rounds;
  for (int i = 0; i < 100; ++i) rounds.push_back({i % 2 == 0 ? 1.0 : 3.0, 1});
  const TimeRatio ratio = time_ratio(rounds).value();
  EXPECT_DOUBLE_EQ(ratio.value, 2);
  // The mean of 100 numbers whose deviation is 1: two standard errors are 0.2.
  EXPECT_NEAR(ratio.low, 1.8, 0.05);
  EXPECT_NEAR(ratio.high, 2.2, 0.05);
}

TEST(WidthWithoutBars, IsThatOfASceneWithNothingBehind) {
  SceneData box;  // seen from 4 before its front: it reaches a tangent of 1 / 4
  box.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, box.add_material(MaterialDescription()));
  CameraParameters camera;
  camera.look_from = {0, 0, 4};
  camera.fov_degrees = 2 * std::atan(0.25f) * 180 / pi;  // all of its height
  EXPECT_EQ(width_without_bars(box, camera, {600, 300}), 300);
  EXPECT_EQ(width_without_bars(box, camera, {250, 300}), 250);
  box.add_quad({-1.5f, -1, 0}, {3, 0, 0}, {0, 2, 0}, 0);
  EXPECT_NEAR(width_without_bars(box, camera, {600, 300}), 450, 1);
  box.add_quad({-3, -1, 0}, {6, 0, 0}, {0, 2, 0}, 0);
  EXPECT_EQ(width_without_bars(box, camera, {600, 300}), 600);
  SceneData sky = box;
  sky.quads.resize(1), sky.sky.zenith = Color(1);
  EXPECT_EQ(width_without_bars(sky, camera, {600, 300}), 600) << "it is bright there";
  box.quads.resize(1);
  EXPECT_EQ(width_without_bars(box, camera, {600, 300}), 300);
  box.add_quad({-1, -1, 5}, {2, 0, 0}, {0, 2, 0}, 0);
  EXPECT_EQ(width_without_bars(box, camera, {600, 300}), 600) << "the camera is in it";
}

TEST(WidthWithoutBars, IsOnlyForScenesAndUsersThatSetNone) {
  const auto width = [](const Words& words) {
    return LiveRender(settings_from(words), {}).state().settings.size.width;
  };
  const Words plain{{"scene", "cornell"}, {"output", "page.png"}, {"device", "cpu"}};
  EXPECT_EQ(width(plain), 300);
  EXPECT_EQ(width({{"scene", "spheres"}, {"output", "page.png"}, {"device", "cpu"}}), 600);
  Words given = plain;
  given.push_back({"height", "300"});
  EXPECT_EQ(width(given), 600);
}

}  // namespace
