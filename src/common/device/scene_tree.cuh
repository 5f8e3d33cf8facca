// The tree over a scene's triangles, built on the CUDA device.
#pragma once

#include "common/device/cuda_memory.cuh"
#include "common/render/options.h"
#include "common/render/stats.h"
#include "common/scene/scene_data.h"

namespace pt {

/// Uploads the meshes, builds the tree that the options ask for into `memory`, and says in `facts`
/// what it is like. `scene` has no instances. Throws Error where the device has too little memory.
TriangleTree build_scene_tree(const SceneData& scene, const Options& options, CudaMemory& memory,
                              TreeFacts& facts);

}  // namespace pt
