#include "app/render/rendering.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "app/render/make_renderer.h"
#include "app/report/film_header.h"
#include "common/device/cpu/cpu_renderer.h"
#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/mpi/ranks.h"
#include "common/options/option_names.h"
#include "common/platform/steady_seconds.h"

namespace pt {

namespace {

std::string label(const Options& options, int index) {
  if (index < options.warmup) return fmt::format("warm-up {} of {}", index + 1, options.warmup);
  if (options.repeat == 1) return "rendering";
  return fmt::format("render {} of {}", index - options.warmup + 1, options.repeat);
}

}  // namespace

Measurement measure(Renderer& renderer, const Options& options, const MeasureHooks& own) {
  const auto& stop = own.stop;
  const RenderHooks hooks{own.progress, stop, {options.time_limit, options.target_error, {}}, stop};
  Measurement measurement;
  RenderRun last;
  for (int i = 0; i < options.warmup + options.repeat; ++i) {
    if (stop()) {
      measurement.interrupted = true;
      if (i > 0 && measurement.runs.empty()) measurement.runs = {last};
      break;
    }
    if (own.begin) own.begin(label(options, i));
    const double begin_s = steady_seconds();
    last = renderer.render(hooks);
    last.wall_ms = 1e3 * (steady_seconds() - begin_s);
    if (is_cut_short(last, options.spp)) {
      measurement = {{last}, true};
      break;
    }
    if (i >= options.warmup) measurement.runs.push_back(last);
  }
  return measurement;
}

std::vector<std::string> names_of(const std::vector<std::unique_ptr<Worker>>& workers) {
  std::vector<std::string> names;
  for (const auto& worker : workers) names.push_back(worker->name());
  return names;
}

Rendering::Rendering(const Options& options, const std::vector<ExecutionPlan>& plans,
                     const SceneData& scene, const std::vector<DeviceInfo>& devices,
                     const Surroundings& surroundings)
    : options_(options) {
  const Ranks* const ranks = surroundings.ranks;
  const bool has_ranks = ranks != nullptr && ranks->count() > 1;
  if (needs_group(options, devices) || has_ranks) {
    make_group(plans, scene, devices, surroundings);
  } else {
    single_ = make_fitting_renderer(plans.front(), scene, devices.front(), surroundings.warn);
  }
}

void Rendering::make_group(const std::vector<ExecutionPlan>& plans, const SceneData& scene,
                           const std::vector<DeviceInfo>& devices,
                           const Surroundings& surroundings) {
  filter_ = scene.filter;
  header_ = film_header(options_, scene.source_hash, to_string(devices.front().choice.kind));
  bell_ = std::make_shared<ResultBell>();
  const auto& warn = surroundings.warn;
  if (!options_.checkpoint.file.empty()) {
    keeper_ = std::make_unique<CheckpointKeeper>(
        options_.checkpoint.interval_s, [this](const ImageFilm& film) { save(film); },
        [warn](const std::string& message) {
          if (warn) warn("--checkpoint: " + message);
        });
  }
  GroupHooks hooks;
  hooks.warn = warn;
  if (keeper_) hooks.film_grew = [this](const ImageFilm& film) { keeper_->film_grew(film); };
  auto workers = make_workers(plans, scene, devices, *bell_);
  Ranks* const ranks = surroundings.ranks;
  const bool has_ranks = ranks != nullptr && ranks->count() > 1;
  if (has_ranks) {
    ranks->announce(names_of(workers));
    const std::uint64_t least_paths = workers.front()->least_paths();
    for (auto& remote : remote_workers(*ranks, least_paths)) workers.push_back(std::move(remote));
  }
  // Nobody rings for what comes from other ranks.
  const std::shared_ptr<ResultBell> bell = has_ranks ? nullptr : bell_;
  group_ = std::make_unique<GroupRenderer>(options_, scene.filter, std::move(workers), bell, hooks);
  if (surroundings.resumption != nullptr)
    group_->start_from(surroundings.resumption->checkpoint.film);
  group_->restrict_to(part_windows(options_));
}

Measurement Rendering::measure(const MeasureHooks& hooks) {
  try {
    Measurement measurement = pt::measure(renderer(), options_, hooks);
    keep();
    return measurement;
  } catch (const std::exception& error) {
    if (options_.checkpoint.file.empty()) throw;
    keep();
    throw Error(message_of(error) + "; " +
                (checkpoint_problem_.empty()
                     ? fmt::format("ptexp resume {} goes on", options_.checkpoint.file)
                     : checkpoint_problem_));
  }
}

void Rendering::keep() {
  checkpoint_problem_.clear();
  try {
    if (keeper_) keeper_->finish(group_->film());
  } catch (const std::exception& error) {
    checkpoint_problem_ = message_of(error);
  }
}

void Rendering::save(const ImageFilm& film) const {
  write_checkpoint(options_.checkpoint.file, {film, header_}, filter_,
                   {0, 0, options_.width, options_.height});
}

namespace {

// A wavefront's pool and a GPU's threads are full for some milliseconds (results/).
constexpr std::uint64_t least_paths_cuda = std::uint64_t{1} << 22;
constexpr std::uint64_t least_paths_per_thread = std::uint64_t{1} << 12;

std::uint64_t least_paths(const DeviceInfo& device) {
  if (device.choice.kind == DeviceChoice::Kind::cuda) return least_paths_cuda;
  return least_paths_per_thread * static_cast<std::uint64_t>(device.properties.threads);
}

std::string name_of(const DeviceInfo& device) {
  const std::string kind = to_string(device.choice.kind);
  return fmt::format("{}:{}", kind, device.choice.index);
}

}  // namespace

bool needs_group(const Options& options, const std::vector<DeviceInfo>& devices) {
  const bool is_divided = std::getenv(units_variable) != nullptr;
  return devices.size() > 1 || !options.checkpoint.file.empty() || options.part.count > 1 ||
         is_divided;
}

std::vector<std::unique_ptr<Worker>> make_workers(const std::vector<ExecutionPlan>& plans,
                                                  const SceneData& scene,
                                                  const std::vector<DeviceInfo>& devices,
                                                  ResultBell& bell) {
  std::vector<std::unique_ptr<Worker>> workers;
  std::vector<LocalWorker*> locals;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const DeviceInfo& device = devices[i];
    const auto make = [plan = plans[i], &scene, device](int halvings) {
      ExecutionPlan own = plan;
      own.memory_halvings = halvings;
      return make_renderer(own, scene, device);
    };
    auto worker = std::make_unique<LocalWorker>(name_of(device), least_paths(device), make, bell);
    locals.push_back(worker.get());
    workers.push_back(std::move(worker));
  }
  for (LocalWorker* worker : locals) worker->wait_until_ready();
  return workers;
}

std::vector<Window> part_windows(const Options& options) {
  const Window image = window_of(options);
  const PartChoice& part = options.part;
  if (part.count == 1) return {image};
  const auto count = static_cast<std::uint32_t>(part.count);
  if (count > image.height) {
    throw Error(fmt::format("--part {}/{}: the image has {} rows; expected at most as many parts",
                            part.index, part.count, image.height));
  }
  constexpr std::uint32_t stripes_per_part = 8;
  const std::uint32_t rows = std::max(1u, image.height / (stripes_per_part * count));
  std::vector<Window> windows;
  for (std::uint32_t y = 0, stripe = 0; y < image.height; y += rows, ++stripe) {
    if (stripe % count + 1 != static_cast<std::uint32_t>(part.index)) continue;
    windows.push_back({image.x, image.y + y, image.width, std::min(rows, image.height - y)});
  }
  return windows;
}

}  // namespace pt
