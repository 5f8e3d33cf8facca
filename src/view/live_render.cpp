#include "view/live_render.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "app/render/rank_setup.h"
#include "app/render/render_outputs.h"
#include "common/error/host_memory.h"
#include "common/options/option_names.h"
#include "common/platform/steady_seconds.h"
#include "common/scene/prepare/prepare_steps.h"

namespace pt {
namespace {

constexpr double pass_limit_ms = 200;
/// The first pass of a camera may take this long after the camera has moved on, so that an image
/// appears while a user drags.
constexpr double grace_s = 0.5;

std::string names_of_devices(const std::vector<DeviceInfo>& devices) {
  std::string names = devices.front().name;
  if (devices.size() > 1) names = fmt::format("{} x {}", devices.size(), names);
  return names;
}

double ms_per_sample(const LiveView& view) {
  return view.pass_samples > 0 ? view.pass_ms / view.pass_samples : 0;
}

/// The setting's value as the option prints it.
std::string value_of(const Setting& setting) {
  Options options;
  setting.entry->set(options, setting.value);
  return setting.entry->text(options);
}

}  // namespace

RenderCommand mode_command(const std::vector<Setting>& settings, Mode mode) {
  std::vector<Setting> chosen;
  for (const Setting& setting : settings) {
    const OptionEntry& entry = *setting.entry;
    const bool is_kept = entry.name != "mode" && entry.group != OptionGroup::camera &&
                         has_effect(entry, value_of(setting), mode);
    if (is_kept) chosen.push_back(setting);
  }
  chosen.push_back({&find_option("mode"), to_string(mode)});
  return make_render_command(chosen);
}

int next_pass(int done, int wanted, double ms_per_sample) {
  const double most = ms_per_sample > 0 ? pass_limit_ms / ms_per_sample : 1;
  const int doubling = std::max(done, 1);
  const int samples = most < doubling ? std::max(static_cast<int>(most), 1) : doubling;
  return std::min(samples, wanted - done);
}

/// The thread's next pass, which it makes without the mutex.
struct LiveRender::Task {
  std::uint64_t number = 0;
  LiveSettings settings;
  std::size_t view = 0;
  int samples = 0;
  bool is_first = false;  ///< the first pass by its settings
};

LiveRender::LiveRender(std::vector<Setting> settings, const Warn& warn)
    : options_(std::move(settings)), warn_(warn) {
  const RenderCommand asked = make_render_command(options_);
  command_ = mode_command(options_, asked.options.mode);
  auto session = std::make_unique<RenderSession>(asked, warn_);
  const SceneData& scene = session->scene();
  Options options = command_.options;
  device_ = names_of_devices(choose_render_devices(options, command_.given));
  apply_defaults(scene.defaults, command_.given, command_.options);
  measures_exposure_ = scene.defaults.measure_exposure;
  const ExposureChoice& exposure = asked.options.exposure;
  if (exposure.kind == ExposureChoice::Kind::fixed) {
    has_exposure_ = true;
    state_.exposure = exposure.stops;
  }
  camera_ = scene.camera;
  override_camera(camera_, asked.options.camera);

  state_.settings.modes = {asked.options.mode};
  state_.views.resize(1);
  state_.views.front().mode = asked.options.mode;
  workers_.emplace_back().session = std::move(session);
  arrange_workers({number_, state_.settings});
  workers_.front().session->plan(workers_.front().command);  // errors, before anybody looks
  thread_ = std::thread([this] { run(); });
}

LiveRender::~LiveRender() {
  end();
  thread_.join();
}

void LiveRender::end() {
  const std::lock_guard lock(mutex_);
  ends_ = true;
  wake_.notify_all();
  changed_.notify_all();
}

void LiveRender::change(const LiveSettings& settings) {
  const std::lock_guard lock(mutex_);
  if (settings == state_.settings) return;
  std::vector<LiveView> views;
  for (const Mode mode : settings.modes) {
    const auto before =
        std::ranges::find_if(state_.views, [&](const LiveView& one) { return one.mode == mode; });
    LiveView view = before != state_.views.end() ? *before : LiveView();
    view.mode = mode;
    view.samples = 0;
    views.push_back(std::move(view));
  }
  state_.views = std::move(views);
  state_.settings = settings;
  state_.error.clear();
  ++state_.version;
  ++number_;
  target_ = 0;
  wake_.notify_all();
  changed_.notify_all();
}

void LiveRender::change_exposure(float stops) {
  const std::lock_guard lock(mutex_);
  has_exposure_ = true;
  if (stops == state_.exposure) return;
  state_.exposure = stops;
  ++state_.version;
  changed_.notify_all();
}

void LiveRender::set_watched(bool is_watched) {
  if (is_watched == is_watched_) return;
  const std::lock_guard lock(mutex_);
  is_watched_ = is_watched;
  wake_.notify_all();
}

LiveState LiveRender::state() const {
  const std::lock_guard lock(mutex_);
  LiveState state = state_;
  const bool is_done = std::ranges::all_of(
      state.views, [&](const LiveView& view) { return view.samples >= samples_wanted(); });
  state.status = !state.error.empty() ? LiveStatus::failed
                 : is_done            ? LiveStatus::done
                 : is_watched_        ? LiveStatus::rendering
                                      : LiveStatus::idle;
  return state;
}

LiveState LiveRender::wait(std::uint64_t version, double seconds) const {
  {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::duration<double>(seconds),
                      [&] { return ends_ || state_.version != version; });
  }
  return state();
}

bool LiveRender::has_work() const {
  return is_watched_ && state_.error.empty() &&
         std::ranges::any_of(state_.views,
                             [&](const LiveView& view) { return view.samples < samples_wanted(); });
}

LiveRender::Task LiveRender::next_task() {
  const std::vector<LiveView>& views = state_.views;
  int least = samples_wanted();
  for (const LiveView& view : views) least = std::min(least, view.samples);
  if (least >= target_) {  // all have the same, so that the images can be compared
    double slowest = 0;
    for (const LiveView& view : views) slowest = std::max(slowest, ms_per_sample(view));
    target_ = least + next_pass(least, samples_wanted(), slowest);
  }
  // By turns, also when every camera lasts for one pass only.
  std::size_t chosen = last_;
  for (std::size_t turn = 0; turn < views.size(); ++turn) {
    chosen = (chosen + 1) % views.size();
    if (views[chosen].samples <= least) break;
  }
  last_ = chosen;
  const int samples = views[chosen].samples;
  return {number_, state_.settings, chosen, target_ - samples, samples == 0};
}

void LiveRender::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [&] { return ends_ || has_work(); });
    if (ends_) return;
    const Task task = next_task();
    lock.unlock();
    RenderPass pass;
    std::string error;
    try {
      pass = do_pass(task);
    } catch (const std::exception& thrown) {
      error = message_of(thrown);
    }
    lock.lock();
    error.empty() ? record(task, std::move(pass)) : record(task, error);
  }
}

void LiveRender::arrange_workers(const Task& task) {
  const std::vector<Mode>& modes = task.settings.modes;
  workers_.resize(std::min(workers_.size(), modes.size()));  // memory first
  for (std::size_t i = 0; i < modes.size(); ++i) {
    if (i == workers_.size()) {
      auto session = std::make_unique<RenderSession>(workers_.front().session->scene());
      workers_.emplace_back().session = std::move(session);
    }
    workers_[i].command = mode_command(options_, modes[i]);
    workers_[i].session->change_camera() = orbit_camera(camera_, task.settings.orbit);
  }
  arranged_ = task.number;
}

RenderPass LiveRender::do_pass(const Task& task) {
  if (arranged_ != task.number) arrange_workers(task);
  const double begin_s = steady_seconds();
  const auto is_unwanted = [&] {
    if (ends_ || !is_watched_) return true;
    return number_ != task.number && (!task.is_first || steady_seconds() - begin_s > grace_s);
  };
  // Once some threads have abandoned a batch all must, even if a viewer comes back meanwhile: the
  // batch is incomplete.
  std::atomic<bool> is_abandoned{false};
  RenderHooks hooks;
  hooks.cancel = [&] {
    if (!is_abandoned && is_unwanted()) is_abandoned = true;
    return is_abandoned.load();
  };
  hooks.stop = hooks.cancel;
  const Worker& worker = workers_[task.view];
  return worker.session->add_pass(worker.command, task.samples, hooks, warn_);
}

void LiveRender::record(const Task& task, RenderPass pass) {
  const Mode mode = task.settings.modes[task.view];
  const auto view =
      std::ranges::find_if(state_.views, [&](const LiveView& one) { return one.mode == mode; });
  if (view == state_.views.end() || pass.run.samples_done == 0) return;
  if (task.number == number_) view->samples = pass.samples;
  view->pass_samples = pass.run.samples_done;
  view->pass_ms = pass.run.kernel_ms;
  const double pixels = static_cast<double>(pass.image.width) * pass.image.height;
  view->msamples_per_s = view->pass_ms > 0 ? pixels * view->pass_samples / view->pass_ms / 1e3 : 0;
  if (!has_exposure_) {
    has_exposure_ = true;
    const auto exposure = exposure_for(command_.options.output, command_.options.exposure,
                                       pass.image, measures_exposure_);
    if (exposure) state_.exposure = exposure->stops;
  }
  view->image = std::make_shared<const Image>(std::move(pass.image));
  ++state_.version;
  view->image_number = state_.version;
  changed_.notify_all();
}

void LiveRender::record(const Task& task, const std::string& error) {
  if (task.number != number_) return;  // what is asked for now may succeed
  state_.error = error;
  ++state_.version;
  changed_.notify_all();
}

}  // namespace pt
