// Picks the renderer: the only place that knows all modes and devices.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "common/device/devices.h"
#include "common/render/renderer.h"
#include "common/scene/scene_data.h"

namespace pt {

/// Loads or makes the scene that the options name, on the device where they want it so, and
/// prepares it. What a file asks for and ptexp lacks goes to `warn`, a line each. Throws Error.
SceneData make_scene_for(const Options& options, const DeviceInfo& device,
                         const std::function<void(const std::string&)>& warn = {});

/// `scene` must outlive the renderer. Throws Error when the options ask for something that the
/// device or the mode cannot do, or that does not fit into memory.
std::unique_ptr<Renderer> make_renderer(const Options& options, const SceneData& scene,
                                        const DeviceInfo& device);

}  // namespace pt
