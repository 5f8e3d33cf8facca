// Launches the kernels that trace arrays of rays. Host-facing.
#pragma once

#include "common/accel/ray_record.h"
#include "common/accel/triangle_tree.h"
#include "common/rays/trace_rays.h"

namespace pt {

/// Blocks that fill the current device with persistent warps; asked for once, before measuring.
int persistent_blocks(RayType type, const TriangleTree& tree);

/// In the default stream. `variant` is not automatic; persistent and beam need the nodes of a wide
/// tree, and beam one without instances. Throws Error where the launch fails.
void launch_trace(TraceVariant variant, RayType type, const TriangleTree& tree,
                  const RayArrays& rays, int blocks);

/// The part of a sample of groups of 32 rays, as they lie in the array, that are coherent enough
/// for a beam. Waits for the device.
double measure_coherence(const RayArrays& rays);

}  // namespace pt
