// Renderers in which one thread follows whole paths.
#pragma once

#include <memory>

#include "common/plan/execution_plan.h"
#include "common/render/renderer.h"
#include "common/scene/data/scene_data.h"

namespace pt {

std::unique_ptr<Renderer> make_megakernel_cpu(const ExecutionPlan& plan, const SceneData& scene);

/// `device`: CUDA device ordinal. Only in a build with CUDA.
std::unique_ptr<Renderer> make_megakernel_cuda(const ExecutionPlan& plan, const SceneData& scene,
                                               int device);

}  // namespace pt
