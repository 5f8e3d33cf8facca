#include <fmt/format.h>

#include <future>
#include <optional>
#include <system_error>

#include "app/commands/commands.h"
#include "app/render/calibration.h"
#include "app/render/make_renderer.h"
#include "app/render/rank_setup.h"
#include "app/render/render_outputs.h"
#include "app/render/rendering.h"
#include "app/report/film_header.h"
#include "app/terminal/process.h"
#include "app/terminal/progress.h"
#include "common/device/devices.h"
#include "common/error/error.h"
#include "common/error/terminal.h"
#include "common/image/atomic_file.h"
#include "common/mpi/ranks.h"
#include "common/options/option_names.h"
#include "common/plan/execution_plan.h"
#include "common/platform/steady_seconds.h"
#include "common/render/batches.h"
#include "common/scene/data/scene_facts.h"
#include "common/scene/prepare/prepare_scene.h"

namespace pt {
namespace {

/// Runs `work` and returns its wall time.
template <typename Work>
double timed_ms(const Work& work) {
  const double begin_s = steady_seconds();
  work();
  return 1e3 * (steady_seconds() - begin_s);
}

/// Finds and prints the devices. The options then name these.
std::vector<DeviceInfo> find_devices(Options& options, const GivenOptions& given,
                                     const Ranks& ranks) {
  using Kind = DeviceChoice::Kind;
  const Kind wanted = options.device.kind;
  std::vector<DeviceInfo> devices = calibrated_devices(options, given, print_warning, &ranks);
  if (options.quiet) return devices;
  for (const DeviceInfo& device : devices) {
    print("device {}: {} ({})\n", to_string(device.choice), limited(device, options.limits).name,
          device.detail);
  }
  const bool is_gpu = devices.front().choice.kind == Kind::cuda;
  const std::size_t gpus = wanted == Kind::automatic && is_gpu ? list_devices().size() - 1 : 0;
  if (gpus > 1 && ranks.count() == 1)
    print("{} GPUs are here; --device cuda:all renders on all of them\n", gpus);
  flush_output();  // before the wait, even into a pipe
  return devices;
}

/// The exposure in stops for the image's format. Prints a measured one.
std::optional<float> choose_exposure(const Options& options, const Image& image, bool by_default) {
  const auto exposure = exposure_for(options.output, options.exposure, image, by_default);
  if (!exposure) return std::nullopt;
  if (exposure->is_measured && !options.quiet)
    print("exposure {:+.2f} stops, measured; --exposure sets another\n", exposure->stops);
  return exposure->stops;
}

/// Writes the image, counts if asked for, then writes the statistics. `has_checkpoint`: a
/// checkpoint has all samples, too.
void write_outputs(const Options& options, const Image& image, const std::string& scene_hash,
                   Renderer& renderer, RenderReport& report, bool has_checkpoint,
                   Attempts& attempts, ProcessClock& clock) {
  const bool is_part = options.part.count > 1;  // its film is in the checkpoint
  const ToneMapping tone_mapping{report.exposure.value_or(0.0f)};
  bool is_written = has_checkpoint;
  if (!is_part) {
    const ImageMetadata metadata = image_header(options, report, scene_hash);
    const std::string advice =
        has_checkpoint ? fmt::format("; ptexp resume {} --output FILE writes its samples",
                                     options.checkpoint.file)
                       : "";
    is_written = attempts.make(
        [&] {
          report.image_write_ms =
              timed_ms([&] { write_image(options.output, image, metadata, tone_mapping); });
        },
        advice);
  }
  clock.end(&ProcessTimes::image);
  report.process_ms = clock.times();
  if (options.counters && is_complete(options, report))
    report.counters = count_hardware(renderer, print_warning);
  if (!options.quiet) {
    print_text(report_table(options, report));
    if (is_written) print("wrote {}\n", is_part ? options.checkpoint.file : options.output);
    flush_printed();  // whether it could be written is asked when all files are there
  }
  write_statistics(options, report, attempts);
}

/// A failed checkpoint is an error for a part, which has no other output, else a warning.
void report_checkpoint(const Options& options, const std::string& problem, Attempts& attempts) {
  if (problem.empty()) return;
  if (options.part.count > 1)
    attempts.make([&] { throw Error(problem); });
  else
    print_warning("--checkpoint: " + problem);
}

void say_interrupted(const Options& options, const Measurement& measurement, bool has_image,
                     bool has_checkpoint) {
  std::string image = has_image ? fmt::format("image has {} of {} samples per pixel",
                                              measurement.runs.back().samples_done, options.spp)
                                : "no sample was finished, no image written";
  if (has_checkpoint) image += fmt::format("; ptexp resume {} goes on", options.checkpoint.file);
  print_notice("interrupted: " + image +
               (options.csv_file.empty() ? "" : "; no row appended to " + options.csv_file));
}

/// Lets the devices of a rank other than the first work for the first one until it is done.
void serve(Ranks& ranks, const std::vector<ExecutionPlan>& plans, const SceneData& scene,
           const std::vector<DeviceInfo>& devices) {
  ResultBell bell;
  const auto workers = make_workers(plans, scene, devices, bell);
  ranks.announce(names_of(workers));
  serve_units(ranks, workers);
}

/// Says once what --target-error will take, unless the film of a checkpoint has further samples.
Measurement measure_and_show(Rendering& rendering, const Options& options, bool is_resumed) {
  Progress progress(stderr, progress_style(stderr, options.quiet));
  const std::uint64_t pixels = window_of(options).pixel_count();
  bool has_said = options.quiet || is_resumed || options.target_error == 0;
  double begin_s = 0;
  MeasureHooks hooks;
  hooks.begin = [&](const std::string& label) {
    progress.begin(label);
    begin_s = steady_seconds();
  };
  hooks.progress = [&](std::uint64_t done, std::uint64_t total) {
    progress.update(done, total);
    if (has_said) return;
    const std::string text =
        forecast_text(options, {pixels, done, total, steady_seconds() - begin_s});
    if (text.empty()) return;
    has_said = true;
    progress.finish();
    print("{}\n", text);
    flush_printed();
  };
  hooks.stop = interrupted;
  return rendering.measure(hooks);
}

/// Throws Error if the scene or the devices give other samples than the checkpoint has.
void check_resumption(const Resumption& resumption, const Options& options,
                      const std::string& scene_hash, const std::vector<DeviceInfo>& devices) {
  const std::string kind = to_string(devices.front().choice.kind);
  check_same_render(resumption.checkpoint.metadata, resumption.file,
                    film_header(options, scene_hash, kind), "this render");
}

struct LoadedScene {
  SceneData scene;
  double load_ms = 0;
};

LoadedScene load_timed(const Options& options, const DeviceInfo& device, Ranks& ranks) {
  const bool warns = ranks.is_first() && !options.quiet;
  LoadedScene loaded;
  loaded.load_ms = timed_ms([&] {
    loaded.scene = load_shared_scene(ranks, options, device, warns ? Warn(print_warning) : Warn());
  });
  return loaded;
}

/// Begins to load the scene while devices are looked for, which takes CUDA's driver 0.2 s. Invalid
/// where the scene depends on the device, or on other ranks.
std::future<LoadedScene> load_early(const Options& options, Ranks& ranks) {
  if (ranks.count() > 1 || options.create_world != WorldBuilder::host) return {};
  try {
    return std::async(std::launch::async,
                      [options, &ranks] { return load_timed(options, {}, ranks); });
  } catch (const std::system_error&) {
    return {};  // there are as many threads as may be: it is loaded later
  }
}

/// `resumption`: the checkpoint that goes on, or null.
int render(const RenderCommand& command, Ranks& ranks, const Resumption* resumption) {
  ProcessClock clock(process_age_s());
  Options options = command.options;
  const bool is_first = ranks.is_first();
  if (is_first) check_outputs(options);
  options.quiet |= !is_first;
  if (is_first) end_on_signal(": no sample was finished, no image written");
  std::future<LoadedScene> early = load_early(options, ranks);
  const std::vector<DeviceInfo> devices = find_devices(options, command.given, ranks);
  if (ranks.count() > 1) check_ranks(ranks, options, devices.front());
  if (const std::string text = binding_warning(ranks.own()); is_first && !text.empty())
    print_warning(text);
  std::optional<DeviceOpening> opening;
  if (options.mode != Mode::serial && !options.explain) opening.emplace(devices);
  clock.end(&ProcessTimes::devices);

  RenderReport report;
  std::vector<ExecutionPlan> plans;
  auto [scene, load_ms] = early.valid() ? early.get() : load_timed(options, devices.front(), ranks);
  clock.end(&ProcessTimes::scene);
  report.scene_ms = load_ms + timed_ms([&, &scene = scene] {
                      apply_defaults(scene.defaults, command.given, options);
                      resolve_scene_for(scene, options, devices.front(),
                                        options.quiet ? Warn() : Warn(print_warning));
                      plans = plan_render(options, scene, devices);
                      if (!options.explain) prepare_scene(scene, plans.front());
                    });
  if (options.explain) {
    if (is_first) print("{}", plan_text(plans.front().decisions));
    return 0;
  }
  if (!is_first) {
    serve(ranks, plans, scene, devices);
    return 0;
  }
  check_not_of_scene(options, scene.source_files);
  if (resumption != nullptr) check_resumption(*resumption, options, scene.source_hash, devices);
  report.primitives = scene.primitive_count() + scene.triangle_count();
  describe_scene(scene, report.scene);
  if (!options.quiet) {
    print("{}", scene_text(report.scene));
    flush_printed();
  }
  clock.end(&ProcessTimes::prepare);
  Rendering rendering(options, plans, scene, devices, {&ranks, resumption, print_warning});
  Renderer& renderer = rendering.renderer();

  note_signals(!options.checkpoint.file.empty());
  clock.end(&ProcessTimes::setup);
  const Measurement measurement = measure_and_show(rendering, options, resumption != nullptr);
  clock.end(&ProcessTimes::render);
  const bool has_image = !measurement.runs.empty() && measurement.runs.back().samples_done > 0;
  const std::string& problem = rendering.checkpoint_problem();
  const bool has_checkpoint = !options.checkpoint.file.empty() && problem.empty();
  Attempts attempts;
  report_checkpoint(options, problem, attempts);
  if (has_image) {
    const Image image = renderer.image();
    const bool is_new = report.scene.tree.nodes == 0;  // built by the renderer
    renderer.describe(report);
    if (is_new && !options.quiet) print("{}", tree_text(report.scene.tree));
    report.runs = measurement.runs;
    if (const std::string text = black_image_text(options, image); !text.empty())
      print_warning(text);
    report.exposure = choose_exposure(options, image, scene.defaults.measure_exposure);
    write_outputs(options, image, scene.source_hash, renderer, report, has_checkpoint, attempts,
                  clock);
  }
  if (measurement.interrupted) say_interrupted(options, measurement, has_image, has_checkpoint);
  attempts.check();
  if (!measurement.interrupted) return 0;
  return exit_code_of_signal();
}

/// Throws Error if the film's samples cannot be continued up to options.spp.
void check_samples(const ImageFilm& film, const Options& before, const Options& options,
                   const std::string& file) {
  std::uint32_t most = 0;
  for (const FilmPart& part : film.parts) most = std::max(most, part.next_sample);
  if (most > static_cast<std::uint32_t>(options.spp)) {
    throw Error(fmt::format("--spp {}: {} has pixels with {} samples; expected at least as many",
                            options.spp, file, most));
  }
  if (options.spp != before.spp && options.sampler == SamplerKind::stratified) {
    throw Error(
        fmt::format("--spp {}: {} was begun for {} samples, over which --sampler stratified "
                    "spreads them; expected the same",
                    options.spp, file, before.spp));
  }
}

}  // namespace

int render_command(const RenderCommand& command, Ranks& ranks) {
  return render(command, ranks, nullptr);
}

int resume_command(const ResumeCommand& command, Ranks& ranks) {
  const Resumption resumption{command.file, read_checkpoint(command.file)};
  const Options before = options_in_header(resumption.checkpoint.metadata, command.file);
  RenderCommand again;
  again.options = before;
  again.options.checkpoint.file = command.file;
  again.options.explain = false;
  apply_settings(command.settings, command.file, again.options);
  for (const Setting& setting : command.settings) again.given.insert(setting.entry->name);
  check_consistent(again.options, again.given);
  if (again.options.part.count == 1) check_not_read("--output", again.options.output, command.file);
  check_samples(resumption.checkpoint.film, before, again.options, command.file);
  // The file's own defaults were applied when the render was begun.
  for (const char* name : {"width", "height", "spp", "max-depth", "rr"}) again.given.insert(name);
  return render(again, ranks, &resumption);
}

}  // namespace pt
