#include "app/render_command.h"

#include <fmt/format.h>

#include <cstdio>
#include <limits>
#include <memory>
#include <optional>

#include "app/checkpoint_keeper.h"
#include "app/film_header.h"
#include "app/interrupt.h"
#include "app/make_group.h"
#include "app/make_renderer.h"
#include "app/measure.h"
#include "app/progress.h"
#include "app/rank_setup.h"
#include "app/report/csv_file.h"
#include "app/report/report.h"
#include "app/resume_command.h"
#include "app/standard_output.h"
#include "common/device/devices.h"
#include "common/error/error.h"
#include "common/image/atomic_file.h"
#include "common/image/codecs/image_io.h"
#include "common/image/measure_exposure.h"
#include "common/mpi/serve_units.h"
#include "common/options/option_names.h"
#include "common/plan/execution_plan.h"
#include "common/scene/data/scene_facts.h"

namespace pt {
namespace {

/// Runs `work` and returns its wall time.
template <typename Work>
double timed_ms(const Work& work) {
  const double begin_s = Progress::steady_seconds();
  work();
  return 1e3 * (Progress::steady_seconds() - begin_s);
}

void check_outputs(const Options& options) {
  check_image_path(options.output);
  if (!options.stats_file.empty()) check_writable(options.stats_file);
  if (!options.checkpoint.file.empty()) check_writable(options.checkpoint.file);
  if (!options.csv_file.empty()) check_csv(options.csv_file, report_csv_row(options, {}));
}

/// Finds the devices for the options and says which. The options then name these.
std::vector<DeviceInfo> find_devices(Options& options, const GivenOptions& given,
                                     const Ranks& ranks) {
  using Kind = DeviceChoice::Kind;
  const bool is_serial = options.mode == Mode::serial;  // one CPU thread, GPU or not
  if (is_serial) options.device = {Kind::cpu, 0};
  const DeviceChoice wanted = options.device;
  const std::vector<DeviceInfo> devices = ranks.count() > 1
                                              ? choose_rank_devices(options, ranks.own())
                                              : choose_devices(wanted, options.threads);
  check_applicable(options, given, devices.front().choice.kind);
  if (!options.quiet) {
    for (const DeviceInfo& device : devices) {
      fmt::print("device {}: {} ({})\n", to_string(device.choice), device.name, device.detail);
    }
    const bool is_gpu = devices.front().choice.kind == Kind::cuda;
    const std::size_t gpus =
        wanted.kind == Kind::automatic && is_gpu ? list_devices().size() - 1 : 0;
    if (gpus > 1 && ranks.count() == 1)
      fmt::print("{} GPUs are here; --device cuda:all renders on all of them\n", gpus);
    flush_output();  // before the wait, even into a pipe
  }
  options.device = devices.front().choice;
  for (std::size_t i = 1; i < devices.size(); ++i) {
    options.device.more.push_back(devices[i].choice.index);
  }
  return devices;
}

/// The stops for a format that has no place for radiance.
std::optional<float> exposure_of(const Options& options, const Image& image, bool by_default) {
  using Kind = ExposureChoice::Kind;
  const std::string ending = image_ending(options.output);
  if (ending == ".exr") return std::nullopt;
  const bool measured = options.exposure.kind == Kind::measured ||
                        (options.exposure.kind == Kind::scene && by_default && ending == ".png");
  const float stops = measured ? measure_exposure(image) : options.exposure.stops;
  if (measured && !options.quiet) {
    fmt::print("exposure {:+.2f} stops, measured; --exposure sets another\n", stops);
  }
  return stops;
}

void warn(const std::string& message) { fmt::print(stderr, "ptexp: warning: {}\n", message); }

/// What could not be counted is no reason to lose what was rendered.
HardwareCounters count(Renderer& renderer) {
  try {
    return renderer.count_hardware();
  } catch (const Error& error) {
    warn(std::string("--counters: ") + error.what());
    HardwareCounters none;
    none.problem = error.what();
    return none;
  }
}

/// The image, then what there is to tell about it; in between what a profiler does to the process.
/// CSV rows are for comparing: complete runs only.
void write_outputs(const Options& options, const Image& image, const std::string& scene_hash,
                   Renderer& renderer, RenderReport& report) {
  const bool is_part = options.part.count > 1;  // its film is in the checkpoint
  const ToneMapping tone_mapping{report.exposure.value_or(0.0f)};
  if (!is_part) {
    ImageMetadata metadata = report_metadata(options, report);
    metadata.merge(film_header(options, scene_hash, report.device_kind));
    report.image_write_ms =
        timed_ms([&] { write_image(options.output, image, metadata, tone_mapping); });
  }
  if (options.counters && is_complete(options, report)) report.counters = count(renderer);
  if (!options.quiet) {
    fmt::print("{}wrote {}\n", report_table(options, report),
               is_part ? options.checkpoint.file : options.output);
    std::fflush(stdout);  // whether it could be written is asked when all files are there
  }
  if (!options.stats_file.empty())
    write_file_atomically(options.stats_file, report_json(options, report));
  if (!options.csv_file.empty() && is_complete(options, report))
    append_csv_row(options.csv_file, report_csv_row(options, report));
}

/// What the scene's file asks for holds where the command line says nothing.
void apply_defaults(const SceneDefaults& defaults, const GivenOptions& given, Options& options) {
  const auto apply = [&](const char* name, const std::optional<int>& value, int Options::*field) {
    if (value && !given.contains(name)) options.*field = *value;
  };
  apply("width", defaults.width, &Options::width);
  apply("height", defaults.height, &Options::height);
  apply("spp", defaults.spp, &Options::spp);
  apply("max-depth", defaults.max_depth, &Options::max_depth);
  apply("rr", defaults.rr_depth, &Options::rr_depth);
  if (!options.crop) options.crop = defaults.crop;
  if (!options.filter) options.filter = defaults.filter;
  check_crop(options);
  // A stop is asked to decide: the number of samples does only where it is given.
  const bool has_stop = options.time_limit > 0 || options.target_error > 0;
  if (has_stop && !given.contains("spp")) options.spp = std::numeric_limits<int>::max();
}

void say_interrupted(const Options& options, const Measurement& measurement, bool has_image) {
  std::string image = has_image ? fmt::format("image has {} of {} samples per pixel",
                                              measurement.runs.back().samples_done, options.spp)
                                : "no sample was finished, no image written";
  const std::string& checkpoint = options.checkpoint.file;
  if (!checkpoint.empty()) {
    image += fmt::format("; ptexp resume {} goes on", checkpoint);
  }
  fmt::print(stderr, "ptexp: interrupted: {}{}\n", image,
             options.csv_file.empty() ? "" : "; no row appended to " + options.csv_file);
}

std::vector<std::string> names_of(const std::vector<std::unique_ptr<Worker>>& workers) {
  std::vector<std::string> names;
  for (const auto& worker : workers) names.push_back(worker->name());
  return names;
}

/// Of a rank but the first: its devices work for that one until it needs them no more.
void serve(Ranks& ranks, const Options& options, const SceneData& scene,
           const std::vector<DeviceInfo>& devices) {
  ResultBell bell;
  const auto workers = make_workers(options, scene, devices, bell);
  ranks.announce(names_of(workers));
  serve_units(ranks, workers);
}

/// One device's renderer, or a group whose film may be kept.
class Rendering {
 public:
  Rendering(const Options& options, const SceneData& scene, const std::vector<DeviceInfo>& devices,
            Ranks& ranks, const Resumption* resumption)
      : options_(options) {
    const bool has_ranks = ranks.count() > 1 && !options.explain;
    if (!needs_group(options, devices) && !has_ranks) {
      single_ = make_fitting_renderer(options, scene, devices.front(), warn);
      return;
    }
    filter_ = scene.filter;
    header_ = film_header(options, scene.source_hash, to_string(devices.front().choice.kind));
    bell_ = std::make_shared<ResultBell>();
    if (!options.checkpoint.file.empty()) {
      keeper_ = std::make_unique<CheckpointKeeper>(
          options.checkpoint.interval_s, [this](const ImageFilm& film) { save(film); },
          [](const std::string& message) { warn("--checkpoint: " + message); });
    }
    GroupHooks hooks;
    hooks.warn = warn;
    if (keeper_) hooks.film_grew = [this](const ImageFilm& film) { keeper_->film_grew(film); };
    auto workers = make_workers(options, scene, devices, *bell_);
    if (has_ranks) {
      ranks.announce(names_of(workers));
      const std::uint64_t least_paths = workers.front()->least_paths();
      for (auto& remote : remote_workers(ranks, least_paths)) workers.push_back(std::move(remote));
    }
    // Nobody rings for what comes from other ranks.
    const std::shared_ptr<ResultBell> bell = has_ranks ? nullptr : bell_;
    group_ =
        std::make_unique<GroupRenderer>(options, scene.filter, std::move(workers), bell, hooks);
    if (resumption != nullptr) group_->start_from(resumption->checkpoint.film);
    group_->restrict_to(part_windows(options));
  }

  Renderer& renderer() { return group_ ? *group_ : *single_; }

  /// What was rendered is in the checkpoint, whatever ended the render.
  void keep() {
    if (keeper_) keeper_->finish(group_->film());
  }

 private:
  void save(const ImageFilm& film) const {
    write_checkpoint(options_.checkpoint.file, {film, header_}, filter_,
                     {0, 0, options_.width, options_.height});
  }

  const Options& options_;
  PixelFilter filter_{};
  ImageMetadata header_;
  std::unique_ptr<Renderer> single_;
  std::shared_ptr<ResultBell> bell_;
  std::unique_ptr<CheckpointKeeper> keeper_;
  std::unique_ptr<GroupRenderer> group_;
};

Measurement measure_and_keep(Rendering& rendering, const Options& options) {
  Progress progress(stderr, progress_style(stderr, options.quiet));
  try {
    Measurement measurement = measure(rendering.renderer(), options, progress, interrupted);
    rendering.keep();
    return measurement;
  } catch (const std::exception& error) {
    progress.finish();
    if (options.checkpoint.file.empty()) throw;
    rendering.keep();
    throw Error(fmt::format("{}; ptexp resume {} goes on", error.what(), options.checkpoint.file));
  }
}

}  // namespace

int render_command(const RenderCommand& command, Ranks& ranks, const Resumption* resumption) {
  Options options = command.options;
  const bool is_first = ranks.is_first();
  if (is_first) check_outputs(options);
  options.quiet |= !is_first;
  const std::vector<DeviceInfo> devices = find_devices(options, command.given, ranks);
  if (ranks.count() > 1) check_ranks(ranks, options, devices.front());
  if (is_first) end_on_signal(": no sample was finished, no image written");

  RenderReport report;
  SceneData scene;
  report.scene_ms = timed_ms([&] {
    scene = make_shared_scene(ranks, options, devices.front(), is_first ? Warn(warn) : Warn());
  });
  apply_defaults(scene.defaults, command.given, options);
  if (!is_first) {
    if (!options.explain) serve(ranks, options, scene, devices);
    return 0;
  }
  if (resumption != nullptr) check_resumption(*resumption, options, scene.source_hash, devices);
  report.primitives = scene.primitive_count() + scene.triangle_count();
  describe_scene(scene, report.scene);
  if (!options.quiet) {
    fmt::print("{}", scene_text(report.scene));
    std::fflush(stdout);
  }
  Rendering rendering(options, scene, devices, ranks, resumption);
  Renderer& renderer = rendering.renderer();

  if (options.explain) {
    renderer.describe(report);
    fmt::print("{}", plan_text(report.plan));
    return 0;
  }

  note_signals(!options.checkpoint.file.empty());
  const Measurement measurement = measure_and_keep(rendering, options);
  const bool has_image = !measurement.runs.empty() && measurement.runs.back().samples_done > 0;
  if (has_image) {
    const Image image = renderer.image();
    const bool is_new = report.scene.tree.nodes == 0;  // built by the renderer
    renderer.describe(report);
    if (is_new && !options.quiet) fmt::print("{}", tree_text(report.scene.tree));
    report.runs = measurement.runs;
    report.exposure = exposure_of(options, image, scene.defaults.measure_exposure);
    write_outputs(options, image, scene.source_hash, renderer, report);
  }
  if (!measurement.interrupted) return 0;
  say_interrupted(options, measurement, has_image);
  return exit_code_of_signal();
}

}  // namespace pt
