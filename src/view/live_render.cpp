#include "view/live_render.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "app/render/rank_setup.h"
#include "app/render/render_outputs.h"
#include "app/report/film_header.h"
#include "app/report/report.h"
#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/film/aov.h"
#include "common/options/option_names.h"
#include "common/platform/steady_seconds.h"
#include "common/scene/prepare/prepare_steps.h"

namespace pt {
namespace {

constexpr double pass_limit_ms = 200;
/// The first pass of a camera may take this long after the camera has moved on, so that an image
/// appears while a user drags.
constexpr double grace_s = 0.5;
/// Always rendered: the noise is estimated by one, and the film has the sums of the other, too.
constexpr std::uint32_t usual_aovs = aov_bit<aov::Variance> | aov_bit<aov::Rays>;
constexpr std::size_t rounds_most = 200;  // that the ratio of two modes is of

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

/// relative_error (pixel_statistics.h), by the image's layer.
std::optional<double> relative_error_of(const Image& image, int samples) {
  const auto layer = std::ranges::find(image.layers, aov::Variance::name, &ImageLayer::name);
  if (samples < 2 || layer == image.layers.end()) return std::nullopt;
  double variance = 0, sum = 0;
  for (std::size_t i = 0; i < layer->values.size(); ++i) {
    const float* const c = &image.rgb[3 * i];
    sum += 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
    variance += layer->values[i];
  }
  if (variance == 0) return 0;
  const auto pixels = static_cast<double>(layer->values.size());
  return std::sqrt(variance / pixels) / std::abs(sum / pixels);
}

void add_stages(const std::vector<StageTime>& more, std::vector<StageTime>& stages) {
  for (const StageTime& one : more) {
    auto stage = std::ranges::find(stages, one.stage, &StageTime::stage);
    if (stage == stages.end()) stage = stages.insert(stage, {one.stage});
    stage->time_ms += one.time_ms, stage->launches += one.launches;
  }
}

/// A plan goes through the scene, so it is made only where it decides the mode.
Decision mode_decision(RenderSession& session, const RenderCommand& command) {
  const Mode mode = command.options.mode;
  if (mode == Mode::automatic)
    for (Decision& one : session.plan(command))
      if (one.option == "mode") return std::move(one);
  return {"mode", to_string(mode), ""};
}

/// What edits of materials and lights read and write, and no geometry.
SceneData materials_and_lights(const SceneData& scene) {
  SceneData part;
  part.names = scene.names;
  part.camera = scene.camera;
  part.sky = scene.sky, part.sun = scene.sun;
  part.delta_lights = scene.delta_lights;
  part.materials = scene.materials;
  return part;
}

bool is_sky_black(const SceneData& scene) {
  return is_black(scene.sky.nadir) && is_black(scene.sky.zenith) && scene.environment.width == 0 &&
         !(scene.sun.one_minus_cos > 0);
}

CropWindow scaled_crop(const CropWindow& crop, const ImageSize& from, const ImageSize& to) {
  const auto x = [&](int column) {
    return static_cast<int>(std::int64_t{column} * to.width / from.width);
  };
  const auto y = [&](int row) {
    return static_cast<int>(std::int64_t{row} * to.height / from.height);
  };
  CropWindow result{x(crop.x0), y(crop.y0), x(crop.x1), y(crop.y1)};
  result.x1 = std::max(result.x1, result.x0 + 1), result.y1 = std::max(result.y1, result.y0 + 1);
  return result;
}

}  // namespace

int width_without_bars(const SceneData& scene, const CameraParameters& camera,
                       const ImageSize& size) {
  if (camera.orthographic || !is_sky_black(scene)) return size.width;
  const Bounds bounds = scene_bounds(scene);
  const Vec3 forward = glm::normalize(camera.look_at - camera.look_from);
  const Vec3 right = glm::normalize(glm::cross(forward, camera.up));
  float side = 0;  // the largest tangent of a corner
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 at((corner & 1) != 0 ? bounds.max.x : bounds.min.x,
                  (corner & 2) != 0 ? bounds.max.y : bounds.min.y,
                  (corner & 4) != 0 ? bounds.max.z : bounds.min.z);
    const float depth = glm::dot(at - camera.look_from, forward);
    if (!(depth > 0)) return size.width;  // the camera is among it
    side = std::max(side, std::abs(glm::dot(at - camera.look_from, right)) / depth);
  }
  const double width =
      size.height * double{side} / vertical_tangent(camera, size.width, size.height);
  return static_cast<int>(
      std::clamp<double>(std::ceil(width), std::min(size.height, size.width), size.width));
}

std::optional<TimeRatio> time_ratio(std::span<const Round> rounds) {
  if (rounds.size() < rounds_min) return std::nullopt;
  const auto ratio = [](const Round& sum) { return sum[1] > 0 ? sum[0] / sum[1] : 0; };
  Round all{};
  for (const Round& round : rounds) all[0] += round[0], all[1] += round[1];
  const auto [low, high] =
      bootstrap_interval(rounds.size(), 1000, [&](std::span<const std::size_t> indices) {
        Round sum{};
        for (const std::size_t i : indices) sum[0] += rounds[i][0], sum[1] += rounds[i][1];
        return ratio(sum);
      });
  return TimeRatio{ratio(all), low, high, rounds.size()};
}

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
  std::uint32_t aovs = 0;
  int spp = 0;
  std::size_t view = 0;
  int samples = 0;
  bool is_first = false;  ///< the first pass by its settings
};

struct LiveRender::Result {
  RenderPass pass;
  std::optional<double> relative_error;
  Decision decision;
};

LiveRender::LiveRender(std::vector<Setting> settings, const Warn& warn)
    : options_(std::move(settings)), warn_(warn) {
  const RenderCommand asked = make_render_command(options_);
  command_ = mode_command(options_, asked.options.mode);
  auto session = std::make_unique<RenderSession>(asked, warn_);
  const SceneData& scene = session->scene();
  Options options = command_.options;
  device_ = names_of_devices(choose_render_devices(options, command_.given));
  device_choice_ = options.device;
  defaults_ = scene.defaults;
  source_hash_ = scene.source_hash;
  apply_defaults(defaults_, command_.given, command_.options);
  measures_exposure_ = defaults_.measure_exposure;
  const ExposureChoice& exposure = asked.options.exposure;
  if (exposure.kind == ExposureChoice::Kind::fixed) {
    has_exposure_ = true;
    state_.display.exposure = exposure.stops;
  }
  camera_ = scene.camera;
  if (scene.moves()) shutter_ = scene.motion.shutter;
  override_camera(camera_, asked.options.camera);
  size_ = {command_.options.width, command_.options.height};
  crop_ = command_.options.crop;
  const bool has_size = asked.given.contains("width") || asked.given.contains("height") ||
                        defaults_.width || defaults_.height || crop_;
  if (!has_size) size_.width = width_without_bars(scene, camera_, size_);
  if (scene.materials.size() <= editable_materials_max) tried_ = materials_and_lights(scene);
  for (const SceneParameter& parameter : scene_parameters(tried_))
    if (parameter.changes.shading) parameters_.push_back({parameter, parameter.get(tried_)});

  state_.settings.modes = {asked.options.mode};
  state_.settings.size = size_;
  state_.spp = command_.options.spp;
  state_.views.resize(1);
  state_.views.front().mode = asked.options.mode;
  aovs_ = usual_aovs;
  workers_.emplace_back().session = std::move(session);
  arrange_workers({number_, state_.settings, aovs_, state_.spp});
  if (asked.options.mode != Mode::automatic)
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

void LiveRender::change(LiveSettings settings) {
  const std::lock_guard lock(mutex_);
  if (settings.size == ImageSize()) settings.size = size_;
  if (settings.time && !shutter_) throw Error("\"time\": nothing moves in this scene");
  check_parameters(settings.parameters);
  if (settings == state_.settings) return;
  std::vector<LiveView> views;
  for (const Mode mode : settings.modes) {
    const auto before =
        std::ranges::find_if(state_.views, [&](const LiveView& one) { return one.mode == mode; });
    LiveView view = before != state_.views.end() ? *before : LiveView();
    view.mode = mode;
    views.push_back(std::move(view));
  }
  state_.views = std::move(views);
  state_.settings = std::move(settings);
  begin_anew();
}

/// Leaves out what is as the scene has it.
void LiveRender::check_parameters(ParameterValues& values) {
  for (auto at = values.begin(); at != values.end();) {
    const auto known = std::ranges::find_if(
        parameters_, [&](const LiveParameter& one) { return one.parameter.name == at->first; });
    if (known == parameters_.end())
      throw Error(
          fmt::format("\"{}\": no such parameter of a material or light", clipped(at->first)));
    if (known->value.size() != at->second.size())
      throw Error(fmt::format("\"{}\": expected {} numbers", at->first, known->value.size()));
    known->parameter.set(tried_, at->second);
    at = known->value == at->second ? values.erase(at) : std::next(at);
  }
}

/// The settings have changed. The mutex is locked.
void LiveRender::begin_anew() {
  for (LiveView& view : state_.views) {
    view.samples = 0, view.kernel_ms = 0, view.wall_ms = 0;
    view.stages.clear(), view.relative_error.reset();
  }
  const std::uint32_t bit = layer_bit(state_.display.layer).value_or(0);
  aovs_ = usual_aovs | bit;
  rounds_.clear(), round_ = {}, state_.ratio.reset();
  state_.error.clear();
  ++state_.version;
  ++number_;
  target_ = 0;
  wake_.notify_all();
  changed_.notify_all();
}

void LiveRender::change_display(const SettingsChange& change) {
  const std::lock_guard lock(mutex_);
  has_exposure_ = has_exposure_ || change.exposure;
  const Display before = state_.display;
  Display& display = state_.display;
  display = {change.layer.value_or(before.layer), change.exposure.value_or(before.exposure),
             change.curve.value_or(before.curve)};
  if (display == before) return;
  const std::uint32_t bit = layer_bit(display.layer).value_or(0);
  if ((aovs_ & bit) != bit || !state_.error.empty()) return begin_anew();
  ++state_.version;
  changed_.notify_all();
}

void LiveRender::change_samples(int spp) {
  const std::lock_guard lock(mutex_);
  if (spp == state_.spp) return;
  state_.spp = spp;
  if (command_.options.sampler == SamplerKind::stratified) return begin_anew();
  target_ = 0;
  ++state_.version;
  wake_.notify_all();
  changed_.notify_all();
}

void LiveRender::set_paused(bool is_paused) {
  const std::lock_guard lock(mutex_);
  if (is_paused == state_.is_paused) return;
  is_paused_ = state_.is_paused = is_paused;
  ++state_.version;
  wake_.notify_all();
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
      state.views, [&](const LiveView& view) { return view.samples >= state.spp; });
  state.status = !state.error.empty() ? LiveStatus::failed
                 : is_done            ? LiveStatus::done
                 : state.is_paused    ? LiveStatus::paused
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
  return is_watched_ && !is_paused_ && state_.error.empty() &&
         std::ranges::any_of(state_.views,
                             [&](const LiveView& view) { return view.samples < state_.spp; });
}

ImageMetadata LiveRender::header_of(const LiveView& view) const {
  const LiveSettings& settings = view.image_settings;
  const CameraParameters camera = orbit_camera(camera_, settings.orbit);
  const bool is_told = settings.parameters.empty() && !settings.time &&
                       !(camera.orthographic && settings.orbit.zoom != 1);
  if (!is_told) {
    std::string text = camera_options(camera);
    if (settings.time) text += fmt::format(" time={}", *settings.time);
    for (const auto& [name, values] : settings.parameters)
      text += fmt::format(" {}={}", name, fmt::join(values, ","));
    return {{"ptexp.view", command_.options.scene + " " + text}};
  }
  RenderCommand command = command_of(settings, view.mode);
  Options& options = command.options;
  apply_defaults(defaults_, command.given, options);
  options.device =
      view.mode == Mode::serial ? DeviceChoice{DeviceChoice::Kind::cpu} : device_choice_;
  options.camera = make_render_command(options_).options.camera;
  if (settings.orbit != Orbit()) {
    const auto list = [](const Vec3& v) { return std::array{v.x, v.y, v.z}; };
    options.camera.look_from = list(camera.look_from),
    options.camera.look_at = list(camera.look_at);
    options.camera.up = list(camera.up);
    if (camera.aperture > 0) options.camera.focus_distance = camera.focus_distance;
  }
  if (options.sampler != SamplerKind::stratified) options.spp = view.image_samples;
  ImageMetadata header = film_header(options, source_hash_, to_string(options.device.kind));
  header["ptexp.device"] = device_;
  header["ptexp.samples_done"] = std::to_string(view.image_samples);
  return header;
}

LiveRender::Task LiveRender::next_task() {
  const std::vector<LiveView>& views = state_.views;
  int least = state_.spp;
  for (const LiveView& view : views) least = std::min(least, view.samples);
  if (least >= target_) {  // all have the same, so that the images can be compared
    double slowest = 0;
    for (const LiveView& view : views) slowest = std::max(slowest, ms_per_sample(view));
    target_ = least + next_pass(least, state_.spp, slowest);
  }
  // By turns, also when every camera lasts for one pass only.
  std::size_t chosen = last_;
  for (std::size_t turn = 0; turn < views.size(); ++turn) {
    chosen = (chosen + 1) % views.size();
    if (views[chosen].samples <= least) break;
  }
  last_ = chosen;
  const int samples = views[chosen].samples;
  return {number_, state_.settings, aovs_, state_.spp, chosen, target_ - samples, samples == 0};
}

void LiveRender::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [&] { return ends_ || has_work(); });
    if (ends_) return;
    const Task task = next_task();
    lock.unlock();
    Result result;
    std::string error;
    try {
      result = do_pass(task);
    } catch (const std::exception& thrown) {
      error = message_of(thrown);
    }
    lock.lock();
    error.empty() ? record(task, std::move(result)) : record(task, error);
  }
}

RenderCommand LiveRender::command_of(const LiveSettings& settings, Mode mode) const {
  RenderCommand command = mode_command(options_, mode);
  const ImageSize size = scaled(settings.size, settings.scale);
  command.options.width = size.width, command.options.height = size.height;
  command.given.insert({"width", "height"});
  if (crop_) command.options.crop = scaled_crop(*crop_, size_, size);
  return command;
}

void LiveRender::arrange_workers(const Task& task) {
  const std::vector<Mode>& modes = task.settings.modes;
  workers_.resize(std::min(workers_.size(), modes.size()));  // memory first
  while (workers_.size() < modes.size()) {
    auto session = std::make_unique<RenderSession>(workers_.front().session->scene());
    workers_.emplace_back().session = std::move(session);
  }
  edit_scenes(task.settings.parameters);
  for (std::size_t i = 0; i < modes.size(); ++i) {
    Worker& worker = workers_[i];
    const RenderCommand before = std::move(worker.command);
    worker.command = command_of(task.settings, modes[i]);
    Options& options = worker.command.options;
    options.aovs = task.aovs;
    if (options.sampler == SamplerKind::stratified) options.spp = task.spp;
    worker.session->show_instant(task.settings.time);
    worker.session->change_camera() = orbit_camera(camera_, task.settings.orbit);
    const Options& last = before.options;
    const bool is_planned = worker.decision.option == "mode" && last.mode == options.mode &&
                            last.width == options.width && last.height == options.height;
    if (!is_planned) worker.decision = mode_decision(*worker.session, worker.command);
  }
  arranged_ = task.number;
}

/// Gives the workers' scenes these values, and to what was edited before those of the file.
void LiveRender::edit_scenes(const ParameterValues& values) {
  if (values == edited_) return;
  for (const Worker& worker : workers_) {
    for (const LiveParameter& one : parameters_) {
      const auto found = values.find(one.parameter.name);
      const bool is_wanted = found != values.end();
      if (!is_wanted && !edited_.contains(one.parameter.name)) continue;
      const std::vector<float>& value = is_wanted ? found->second : one.value;
      worker.session->change_scene(one.parameter.changes,
                                   [&](SceneData& scene) { one.parameter.set(scene, value); });
    }
  }
  edited_ = values;
}

LiveRender::Result LiveRender::do_pass(const Task& task) {
  if (arranged_ != task.number) arrange_workers(task);
  const double begin_s = steady_seconds();
  const auto is_unwanted = [&] {
    if (ends_ || is_paused_ || !is_watched_) return true;
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
  RenderPass pass = worker.session->add_pass(worker.command, task.samples, hooks, warn_);
  const std::optional<double> error = relative_error_of(pass.image, pass.samples);
  return {std::move(pass), error, worker.decision};
}

void LiveRender::record(const Task& task, Result result) {
  RenderPass& pass = result.pass;
  const Mode mode = task.settings.modes[task.view];
  const auto view =
      std::ranges::find_if(state_.views, [&](const LiveView& one) { return one.mode == mode; });
  if (view == state_.views.end() || pass.run.samples_done == 0) return;
  view->pass_samples = pass.run.samples_done;
  view->pass_ms = pass.run.kernel_ms;
  const double pixels = static_cast<double>(pass.image.width) * pass.image.height;
  view->msamples_per_s = view->pass_ms > 0 ? pixels * view->pass_samples / view->pass_ms / 1e3 : 0;
  view->decision = std::move(result.decision);
  const bool is_present = task.number == number_;
  if (is_present) {
    view->samples = pass.samples;
    view->relative_error = result.relative_error;
    view->kernel_ms += pass.run.kernel_ms, view->wall_ms += pass.run.wall_ms;
    add_stages(pass.run.stages, view->stages);
    add_round(task, view->pass_ms);
  }
  if (!has_exposure_) {
    has_exposure_ = true;
    const auto exposure = exposure_for(command_.options.output, command_.options.exposure,
                                       pass.image, measures_exposure_);
    if (exposure) state_.display.exposure = exposure->stops;
  }
  view->image = std::make_shared<const Image>(std::move(pass.image));
  view->image_settings = task.settings;
  view->image_samples = pass.samples;
  ++state_.version;
  view->image_number = state_.version;
  changed_.notify_all();
}

/// A round is complete when both modes have its samples. The first one also loads kernels.
void LiveRender::add_round(const Task& task, double pass_ms) {
  if (state_.views.size() != 2) return;
  round_[task.view] += pass_ms;
  const int samples = state_.views.front().samples;
  if (samples < target_ || samples != state_.views.back().samples) return;
  if (samples > 1) rounds_.push_back(round_);
  if (rounds_.size() > rounds_most) rounds_.erase(rounds_.begin());
  round_ = {};
  state_.ratio = time_ratio(rounds_);
}

void LiveRender::record(const Task& task, const std::string& error) {
  if (task.number != number_) return;  // what is asked for now may succeed
  state_.error = error;
  ++state_.version;
  changed_.notify_all();
}

}  // namespace pt
