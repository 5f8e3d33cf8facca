// The triangles of `ptexp trace` and `ptexp rays`, and rays against them on a device.
#pragma once

#include <string>

#include "common/device/devices.h"
#include "common/rays/trace_rays.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Throws Error for a tree, builder or variant that the device does not have.
void check_tracing(const TreeOptions& options, const TraceRuns& runs, const DeviceInfo& device);

/// Traces rays through a tree that the CPU has built.
TraceResult trace_tree(const TriangleTreeData& tree, const RaySet& rays, const TraceRuns& runs,
                       const DeviceInfo& device);

/// Builds the tree on the device of its builder. `options.accel` must not be automatic.
BuiltTrace build_and_trace(const SceneData& scene, const TreeOptions& options, const RaySet& rays,
                           const TraceRuns& runs, const DeviceInfo& device);

/// A .mesh file (TRBMESH1), or any scene as --scene takes it; its quads become triangles.
SceneData load_traced_scene(const std::string& name);

/// The same without its spheres. Throws Error where there are no triangles.
SceneData load_triangles(const std::string& name);

}  // namespace pt
