#include "app/render/render_session.h"

#include <algorithm>
#include <array>
#include <tuple>

#include "app/options/check_options.h"
#include "app/render/calibration.h"
#include "app/render/make_renderer.h"
#include "app/render/rank_setup.h"
#include "app/render/render_outputs.h"
#include "app/render/rendering.h"
#include "app/report/film_header.h"
#include "common/error/error.h"
#include "common/platform/steady_seconds.h"
#include "common/scene/data/scene_facts.h"
#include "common/scene/prepare/prepare_scene.h"

namespace pt {
namespace {

/// Whether neither preparation nor the renderer uses the option.
bool is_for_later(const OptionEntry& entry) {
  constexpr std::array names = {"output", "exposure", "stats", "csv", "quiet", "explain"};
  return std::ranges::any_of(names, [&](const char* name) { return entry.name == name; });
}

/// Whether preparation does not use the option, or by move_camera() or prepares_alike() alone.
bool is_of_renderer(const OptionEntry& entry) {
  constexpr std::array names = {"width", "height", "spp", "seed", "max-depth", "rr", "crop", "aov"};
  using Group = OptionGroup;
  constexpr std::array groups = {Group::camera,    Group::stops,   Group::parts,
                                 Group::execution, Group::toggles, Group::measurement};
  return std::ranges::find(groups, entry.group) != groups.end() ||
         std::ranges::any_of(names, [&](const char* name) { return entry.name == name; });
}

struct Keys {
  std::string scene;     ///< renders of the same key share a prepared scene if their plans agree
  std::string camera;    ///< and those of the same key also its camera
  std::string renderer;  ///< renders of the same key also share a renderer
};

Keys keys_of(const Options& options) {
  Keys keys;
  for (const OptionEntry& entry : option_list()) {
    if (is_for_later(entry)) continue;
    const std::string line = entry.name + ' ' + entry.text(options) + '\n';
    (is_of_renderer(entry) ? keys.renderer : keys.scene) += line;
    if (entry.group == OptionGroup::camera || entry.name == "width" || entry.name == "height")
      keys.camera += line;
  }
  keys.renderer += keys.scene;
  return keys;
}

/// Whether a renderer of one plan is that of the other, where options are the same.
bool renders_alike(const ExecutionPlan& a, const ExecutionPlan& b) {
  const auto of_scene = [](const ExecutionPlan& p) {
    return std::tie(p.mode, p.kernel_set, p.accel, p.traversal, p.light_selection, p.megakernel,
                    p.scene_memory, p.fused, p.orders_surfaces, p.persistent_warps, p.finish_paths,
                    p.finishes_in_blocks, p.pool_paths_max, p.uses_graph, p.calibration,
                    p.decisions);
  };
  return of_scene(a) == of_scene(b);
}

}  // namespace

struct RenderSession::Prepared {
  Options options;
  Keys keys;
  std::vector<DeviceInfo> devices;
  SceneData scene;
  std::vector<ExecutionPlan> plans;  ///< one for each device
  SceneFacts facts;
  double built_cost = 0;  ///< of the tree, when it was built
  double scene_ms = 0;
  Warn warn;  ///< of the render at work
  std::unique_ptr<Rendering> rendering;
  int samples = 0;  ///< of the last pass, in all

  /// Plans for this scene as if it were not prepared yet.
  std::vector<ExecutionPlan> plan_anew(const Options& by, const std::vector<DeviceInfo>& on) {
    const SceneProperties known = scene.properties;
    scene.properties.structure.reset();
    scene.properties.builder.reset();
    std::vector<ExecutionPlan> made = plan_render(by, scene, on);
    scene.properties = known;
    return made;
  }

  void make_rendering() {
    rendering.reset();  // its memory is needed
    rendering = std::make_unique<Rendering>(
        options, plans, scene, devices,
        Rendering::Surroundings{nullptr, nullptr, [this](const std::string& text) {
                                  if (warn) warn(text);
                                }});
  }
};

RenderSession::RenderSession(SceneData scene) : source_(std::move(scene)) {}

RenderSession::~RenderSession() = default;

RenderSession::RenderSession(const RenderCommand& command, const Warn& warn) {
  Options options = command.options;
  const auto devices = choose_render_devices(options, command.given);
  source_ = load_scene(options, devices.front(), warn);
}

void RenderSession::change_scene(const SceneChanges& changes,
                                 const std::function<void(SceneData&)>& edit) {
  edit(source_);
  changes_.add(changes);
}

CameraParameters& RenderSession::change_camera() {
  changes_.camera = true;
  return source_.camera;
}

void RenderSession::show_instant(std::optional<float> time) {
  if (time == instant_) return;
  instant_ = time;
  prepared_.reset();
}

SceneData RenderSession::resolved_scene(const Options& options, const DeviceInfo& device,
                                        const Warn& warn) const {
  SceneData scene = source_;
  if (instant_) hold_still_at(scene, *instant_);
  resolve_scene_for(scene, options, device, warn);
  return scene;
}

/// Prepares again what depends on the changes; the rendering is kept if it can take them over.
/// False: the scene has to be prepared anew.
bool RenderSession::update(Prepared& ready, const Options& options,
                           const std::vector<DeviceInfo>& devices, SceneChanges changes) const {
  SceneData& scene = ready.scene;
  if (source_.moves() && !instant_) {
    SceneProperties moving = scene.properties;
    moving.has_motion = true;
    moving.has_moving_surfaces = source_.deforms() || !source_.motion.instances.empty();
    const bool on_cuda = devices.front().properties.is_cuda;
    if (motion_obstacle(options, moving, on_cuda).empty() != scene.moves()) return false;
  }
  if (!resolve_changes(scene, source_, changes, options)) return false;
  if (ready.rendering && !changes.any_but_camera()) return true;
  std::vector<ExecutionPlan> plans = ready.plan_anew(options, devices);
  if (!has_same_structure(plans.front(), ready.plans.front())) return false;
  changes.lights |= !prepares_alike(plans.front(), ready.plans.front());
  if (!std::ranges::equal(plans, ready.plans, renders_alike)) ready.rendering.reset();
  ready.plans = std::move(plans);
  prepare_changes(scene, changes, ready.plans.front(), ready.facts.tree, ready.built_cost);
  if (changes.any()) describe_scene(scene, ready.facts, false);
  if (ready.rendering && !ready.rendering->renderer().set_scene(scene, changes))
    ready.rendering.reset();
  return true;
}

RenderSession::Prepared& RenderSession::prepare(const RenderCommand& command, const Warn& warn,
                                                ProcessClock& clock) {
  Options options = command.options;
  std::vector<DeviceInfo> devices = calibrated_devices(options, command.given, warn);
  clock.end(&ProcessTimes::devices);
  apply_defaults(source_.defaults, command.given, options);
  Keys keys = keys_of(options);
  for (const DeviceInfo& device : devices)
    keys.renderer += device.properties.constants.calibration + '\n';
  const bool is_same = prepared_ && !changes_.any() && prepared_->keys.renderer == keys.renderer;
  if (is_same) {
    prepared_->scene_ms = 0;
    prepared_->warn = warn;
    prepared_->options = options;
    prepared_->keys = std::move(keys);
    return *prepared_;
  }
  const double begin_s = steady_seconds();
  std::unique_ptr<Prepared> next = std::move(prepared_);  // gone if anything is refused
  if (next && next->keys.renderer != keys.renderer) next->rendering.reset();
  SceneChanges changes = changes_;
  changes.camera |= next && next->keys.camera != keys.camera;
  if (!next || next->keys.scene != keys.scene || !update(*next, options, devices, changes)) {
    next.reset();  // its memory is needed
    next = std::make_unique<Prepared>();
    next->scene = resolved_scene(options, devices.front(), warn);
    next->plans = plan_render(options, next->scene, devices);
    prepare_scene(next->scene, next->plans.front());
    describe_scene(next->scene, next->facts);  // goes through the tree
    next->built_cost = next->facts.tree.sah_cost;
  }
  clock.end(&ProcessTimes::prepare);
  next->scene_ms = 1e3 * (steady_seconds() - begin_s);
  next->warn = warn;
  next->options = options;
  next->keys = std::move(keys);
  next->devices = std::move(devices);
  next->samples = 0;
  const Camera camera = make_camera(next->scene.camera, options.width, options.height);
  if (!next->rendering || !next->rendering->renderer().set_camera(camera)) next->make_rendering();
  clock.end(&ProcessTimes::setup);
  prepared_ = std::move(next);
  changes_ = {};
  return *prepared_;
}

RenderResult RenderSession::render(const RenderCommand& command, const MeasureHooks& hooks,
                                   const Warn& warn, bool stays_on_device) {
  ProcessClock clock;
  Prepared& ready = prepare(command, warn, clock);
  if (stays_on_device && needs_group(ready.options, ready.devices)) {
    throw Error(
        "on_device: several devices, a checkpoint or a part put the image together in the host's "
        "memory; expected one GPU, or on_device=False");
  }
  RenderResult result;
  result.options = ready.options;
  result.measures_exposure = source_.defaults.measure_exposure;
  RenderReport& report = result.report;
  report.scene_ms = ready.scene_ms;
  report.primitives = ready.scene.primitive_count() + ready.scene.triangle_count();
  report.scene = ready.facts;
  const Measurement measurement = ready.rendering->measure(hooks);
  clock.end(&ProcessTimes::render);
  const std::string& problem = ready.rendering->checkpoint_problem();
  if (warn && !problem.empty()) warn("--checkpoint: " + problem);
  result.interrupted = measurement.interrupted;
  result.has_image = !measurement.runs.empty() && measurement.runs.back().samples_done > 0;
  ready.samples = result.has_image ? measurement.runs.back().samples_done : 0;
  if (!result.has_image) return result;
  Renderer& renderer = ready.rendering->renderer();
  if (stays_on_device) result.device_image = renderer.device_image();
  result.image = result.device_image ? result.device_image->frame() : renderer.image();
  clock.end(&ProcessTimes::image);
  report.process_ms = clock.times();
  renderer.describe(report);
  report.runs = measurement.runs;
  if (const std::string text = black_image_text(ready.options, result.image); warn && !text.empty())
    warn(text);
  result.header = image_header(ready.options, report, ready.scene.source_hash);
  if (ready.options.counters && is_complete(ready.options, report))
    report.counters = count_hardware(renderer, warn);
  return result;
}

RenderPass RenderSession::add_pass(const RenderCommand& command, int samples,
                                   const RenderHooks& hooks, const Warn& warn) {
  ProcessClock clock;
  Prepared& ready = prepare(command, warn, clock);
  Renderer& renderer = ready.rendering->renderer();
  RenderPass pass;
  const double begin_s = steady_seconds();
  pass.run = renderer.add(samples, hooks);
  pass.run.wall_ms = 1e3 * (steady_seconds() - begin_s);
  ready.samples += pass.run.samples_done;
  pass.samples = ready.samples;
  if (pass.samples > 0) pass.image = renderer.image();
  return pass;
}

std::vector<Decision> RenderSession::plan(const RenderCommand& command) {
  Options options = command.options;
  const std::vector<DeviceInfo> devices = calibrated_devices(options, command.given, {});
  apply_defaults(source_.defaults, command.given, options);
  const SceneData scene = resolved_scene(options, devices.front(), {});
  return plan_render(options, scene, devices).front().decisions;
}

}  // namespace pt
