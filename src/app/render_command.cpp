#include "app/render_command.h"

#include <fmt/format.h>

#include <cstdio>
#include <limits>
#include <memory>
#include <optional>

#include "app/interrupt.h"
#include "app/make_renderer.h"
#include "app/measure.h"
#include "app/progress.h"
#include "app/report/csv_file.h"
#include "app/report/report.h"
#include "app/standard_output.h"
#include "common/device/devices.h"
#include "common/error/error.h"
#include "common/image/atomic_file.h"
#include "common/image/codecs/image_io.h"
#include "common/image/measure_exposure.h"
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
  if (!options.csv_file.empty()) check_csv(options.csv_file, report_csv_row(options, {}));
}

/// Finds a device for the options and says which.
DeviceInfo find_device(const RenderCommand& command) {
  using Kind = DeviceChoice::Kind;
  const Options& options = command.options;
  const bool is_serial = options.mode == Mode::serial;  // one CPU thread, GPU or not
  const DeviceInfo device = choose_device(is_serial ? DeviceChoice{Kind::cpu, 0} : options.device);
  check_applicable(options, command.given, device.choice.kind);
  if (!options.quiet) {
    fmt::print("device {}: {} ({})\n", to_string(device.choice), device.name, device.detail);
    flush_output();  // before the wait, even into a pipe
  }
  return device;
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
void write_outputs(const Options& options, const Image& image, Renderer& renderer,
                   RenderReport& report) {
  const ToneMapping tone_mapping{report.exposure.value_or(0.0f)};
  report.image_write_ms = timed_ms(
      [&] { write_image(options.output, image, report_metadata(options, report), tone_mapping); });
  if (options.counters && is_complete(options, report)) report.counters = count(renderer);
  if (!options.quiet) {
    fmt::print("{}wrote {}\n", report_table(options, report), options.output);
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
  const std::string image = has_image
                                ? fmt::format("image has {} of {} samples per pixel",
                                              measurement.runs.back().samples_done, options.spp)
                                : "no sample was finished, no image written";
  fmt::print(stderr, "ptexp: interrupted: {}{}\n", image,
             options.csv_file.empty() ? "" : "; no row appended to " + options.csv_file);
}

}  // namespace

int render_command(const RenderCommand& command) {
  check_outputs(command.options);
  const DeviceInfo device = find_device(command);
  Options options = command.options;
  options.device = device.choice;  // what is reported is the device that was used
  end_on_signal(": no sample was finished, no image written");

  RenderReport report;
  SceneData scene;
  report.scene_ms = timed_ms([&] { scene = make_scene_for(options, device, warn); });
  apply_defaults(scene.defaults, command.given, options);
  report.primitives = scene.primitive_count() + scene.triangle_count();
  describe_scene(scene, report.scene);
  if (!options.quiet) {
    fmt::print("{}", scene_text(report.scene));
    std::fflush(stdout);
  }
  const std::unique_ptr<Renderer> renderer = make_renderer(options, scene, device);

  if (options.explain) {
    renderer->describe(report);
    fmt::print("{}", plan_text(report.plan));
    return 0;
  }

  note_signals();
  Progress progress(stderr, progress_style(stderr, options.quiet));
  const Measurement measurement = measure(*renderer, options, progress, interrupted);
  const bool has_image = !measurement.runs.empty() && measurement.runs.back().samples_done > 0;
  if (has_image) {
    const Image image = renderer->image();
    const bool is_new = report.scene.tree.nodes == 0;  // built by the renderer
    renderer->describe(report);
    if (is_new && !options.quiet) fmt::print("{}", tree_text(report.scene.tree));
    report.runs = measurement.runs;
    report.exposure = exposure_of(options, image, scene.defaults.measure_exposure);
    write_outputs(options, image, *renderer, report);
  }
  if (!measurement.interrupted) return 0;
  say_interrupted(options, measurement, has_image);
  return exit_code_of_signal();
}

}  // namespace pt
