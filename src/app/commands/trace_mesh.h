// Rays against triangles, on a device.
#pragma once

#include "common/device/devices.h"
#include "common/rays/trace_rays.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Throws Error for a tree, a builder or a variant that the device does not have.
void check_tracing(const TreeOptions& options, const TraceRuns& runs, const DeviceInfo& device);

/// Against a tree that is built already: by none of a GPU's builders.
TraceResult trace_tree(const TriangleTreeData& tree, const RaySet& rays, const TraceRuns& runs,
                       const DeviceInfo& device);

/// Builds the tree where its builder wants it. `options.accel` is not automatic.
BuiltTrace build_and_trace(const SceneData& scene, const TreeOptions& options, const RaySet& rays,
                           const TraceRuns& runs, const DeviceInfo& device);

}  // namespace pt
