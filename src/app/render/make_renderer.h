// Picks the renderer: the only place that knows all modes and devices.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/device/devices.h"
#include "common/render/renderer.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Called with what a scene file asks for and ptexp lacks, a line each; empty: silence.
using Warn = std::function<void(const std::string&)>;

/// Loads or makes the scene that the options name, on the device where they want it so. Throws
/// Error.
SceneData load_scene(const Options& options, const DeviceInfo& device, const Warn& warn = {});

/// Prepares a scene for rendering by these options, which no longer leave anything to the scene's
/// defaults (scene_defaults.h). Throws Error.
void prepare_scene_for(SceneData& scene, const Options& options, const DeviceInfo& device);

/// Both, for options that say all themselves.
SceneData make_scene_for(const Options& options, const DeviceInfo& device, const Warn& warn = {});

/// `scene` must outlive the renderer. Throws Error when the options ask for something that the
/// device or the mode cannot do, or that does not fit into memory.
std::unique_ptr<Renderer> make_renderer(const Options& options, const SceneData& scene,
                                        const DeviceInfo& device);

/// The same with less memory where the device runs out of it, which `warn` is told (empty: nobody).
std::unique_ptr<Renderer> make_fitting_renderer(const Options& options, const SceneData& scene,
                                                const DeviceInfo& device, const Warn& warn);

}  // namespace pt
