#include "app/render/make_renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "app/terminal/warning_limit.h"
#include "common/device/cpu/cpu_renderer.h"
#include "common/error/error.h"
#include "common/plan/execution_plan.h"
#include "common/render/film_renderer.h"
#include "common/render/memory_share.h"
#include "common/scene/builtin/builtin_scenes.h"
#include "common/scene/builtin/generated_scenes.h"
#include "common/scene/load/files/scene_files.h"
#include "common/scene/load/load_scene.h"
#include "common/scene/prepare/prepare_scene.h"
#include "megakernel/megakernel.h"
#include "serial/serial.h"
#include "wavefront/wavefront.h"

#ifdef PTEXP_CUDA
#include "common/device/cuda/create_world.h"
#endif

namespace pt {
namespace {

/// What is no built-in scene and looks like a path; other names get the list of scenes.
bool is_scene_file(const std::string& scene) {
  const std::string name = scene.substr(0, scene.find(':'));
  const auto& list = scene_list();
  const bool built_in = std::any_of(list.begin(), list.end(),
                                    [&](const SceneInfo& info) { return info.name == name; });
  return !built_in && scene.find_first_of("./") != std::string::npos;
}

}  // namespace

SceneData load_scene(const Options& options, const DeviceInfo& device, const Warn& warn) {
  if (is_scene_file(options.scene)) {
    const SceneFiles files;
    WarningLimit limit(warn);
    SceneData scene = load_scene_file(options.scene, {options.definitions,
                                                      options.strict,
                                                      limit.function(),
                                                      {},
                                                      options.default_lighting,
                                                      options.camera,
                                                      options.volume,
                                                      options.time,
                                                      options.shutter,
                                                      options.animation});
    scene.source_hash = files.hash(std::filesystem::path(options.scene).parent_path());
    for (const auto& path : files.paths()) scene.source_files.push_back(path.string());
    return scene;
  }
  const std::pair<bool, const char*> of_files[] = {
      {options.strict, "strict"},
      {!options.definitions.empty(), "define"},
      {options.default_lighting != DefaultLighting::automatic, "default-lighting"},
      {options.time.has_value(), "time"},
      {options.shutter.has_value(), "shutter"}};
  for (const auto& [is_given, name] : of_files) {
    if (is_given)
      throw Error(
          fmt::format("--{}: is for scene files; '{}' is a built-in scene", name, options.scene));
  }
  if (options.volume != VolumeStorage::automatic && !is_sparse_cloud(options.scene))
    throw Error(fmt::format("--volume: is for scene files and cloud:N:T:A:sparse, not for '{}'",
                            options.scene));
  if (options.create_world == WorldBuilder::host) return build_scene(options);
#ifdef PTEXP_CUDA
  if (device.choice.kind == DeviceChoice::Kind::cuda) {
    return build_scene(options, create_world_on(device.choice.index));
  }
#endif
  throw Error("--create-world device: expected a CUDA device, this is '" + device.name + "'");
}

void resolve_scene_for(SceneData& scene, const Options& options, const DeviceInfo& device,
                       const Warn& warn) {
  resolve_scene(scene, options);
  const std::string why = motion_obstacle(options, scene.properties, device.properties.is_cuda);
  if (why.empty()) return;
  const std::string what =
      fmt::format("scene '{}' moves while the shutter is open: {}", scene.name, why);
  if (options.strict) throw Error(what);
  if (warn) warn(what + ". Rendered without motion, as where it begins");
  hold_still(scene, options);
}

std::vector<ExecutionPlan> plan_render(const Options& options, const SceneData& scene,
                                       const std::vector<DeviceInfo>& devices) {
  check_film(options, scene.properties, scene.filter);
  SceneProperties properties = scene.properties;
  std::vector<ExecutionPlan> plans;
  for (const DeviceInfo& device : devices) {
    DeviceProperties machine = device.properties;
    machine.host_threads = cpu_threads(options.threads);
    plans.push_back(plan_execution(options, properties, machine));
    properties.structure = plans.front().accel;
    properties.why_structure = plans.front().why_accel;
    properties.builder = plans.front().builder;
  }
  return plans;
}

std::unique_ptr<Renderer> make_renderer(const ExecutionPlan& plan, const SceneData& scene,
                                        [[maybe_unused]] const DeviceInfo& device) {
#ifdef PTEXP_CUDA
  if (device.choice.kind == DeviceChoice::Kind::cuda && plan.mode != Mode::serial) {
    return plan.mode == Mode::megakernel ? make_megakernel_cuda(plan, scene, device.choice.index)
                                         : make_wavefront_cuda(plan, scene, device.choice.index);
  }
#endif
  switch (plan.mode) {
    case Mode::serial:
      return make_serial_renderer(plan, scene);
    case Mode::megakernel:
      return make_megakernel_cpu(plan, scene);
    default:
      return make_wavefront_cpu(plan, scene);
  }
}

std::unique_ptr<Renderer> make_fitting_renderer(const ExecutionPlan& plan, const SceneData& scene,
                                                const DeviceInfo& device, const Warn& warn) {
  MemoryShare share;
  auto renderer = make_fitting(share, [&](int halvings) {
    ExecutionPlan own = plan;
    own.memory_halvings = halvings;
    return make_renderer(own, scene, device);
  });
  const std::string warning = share.take_warning();
  if (warn && !warning.empty()) warn(warning);
  return renderer;
}

}  // namespace pt
