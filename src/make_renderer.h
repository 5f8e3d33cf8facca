// Picks the renderer: the only place that knows all modes and devices.
#pragma once

#include <memory>

#include "common/device/devices.h"
#include "common/render/renderer.h"
#include "common/scene/scene_data.h"

namespace pt {

/// Builds and prepares the scene, on the device where the options want it so. Throws Error.
SceneData make_scene_for(const Options& options, const DeviceInfo& device);

/// `scene` must outlive the renderer. Throws Error when the options ask for something that the
/// device or the mode cannot do, or that does not fit into memory.
std::unique_ptr<Renderer> make_renderer(const Options& options, const SceneData& scene,
                                        const DeviceInfo& device);

}  // namespace pt
