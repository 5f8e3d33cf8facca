// The seed's sequential program: one thread, one path at a time. The baseline of all comparisons.
#pragma once

#include <memory>

#include "common/plan/execution_plan.h"
#include "common/render/renderer.h"
#include "common/scene/data/scene_data.h"

namespace pt {

std::unique_ptr<Renderer> make_serial_renderer(const ExecutionPlan& plan, const SceneData& scene);

}  // namespace pt
