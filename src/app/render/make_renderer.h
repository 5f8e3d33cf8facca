// From options to a renderer: load_scene, resolve_scene_for, plan_render, prepare_scene
// (scene/prepare), make_renderer. The only place that knows all modes and devices.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/device/devices.h"
#include "common/plan/execution_plan.h"
#include "common/render/renderer.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Called with what a scene file asks for and ptexp lacks, a line each; empty: silence.
using Warn = std::function<void(const std::string&)>;

/// Loads or makes the scene that the options name, on the device where they want it so. Throws
/// Error.
SceneData load_scene(const Options& options, const DeviceInfo& device, const Warn& warn = {});

/// resolve_scene(). A scene that moves and cannot be blurred by the options or on the device is
/// then held as where its motion begins, which `warn` is told; with --strict that is an Error.
void resolve_scene_for(SceneData& scene, const Options& options, const DeviceInfo& device,
                       const Warn& warn = {});

/// A plan for each device to render this resolved scene; all of them have the structure of the
/// first. The options no longer leave anything to the scene's defaults (apply_defaults,
/// options/check_options.h). Throws Error when they ask for something that the scene, a device or
/// the mode cannot do.
std::vector<ExecutionPlan> plan_render(const Options& options, const SceneData& scene,
                                       const std::vector<DeviceInfo>& devices);

/// `scene` is prepared for a plan of this structure and must outlive the renderer. Throws Error for
/// what does not fit into memory.
std::unique_ptr<Renderer> make_renderer(const ExecutionPlan& plan, const SceneData& scene,
                                        const DeviceInfo& device);

/// The same with less memory where the device runs out of it, which `warn` is told (empty: nobody).
std::unique_ptr<Renderer> make_fitting_renderer(const ExecutionPlan& plan, const SceneData& scene,
                                                const DeviceInfo& device, const Warn& warn);

}  // namespace pt
