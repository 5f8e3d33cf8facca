// What a scene or a device cannot have, whatever an option asks for.
#pragma once

#include "common/plan/execution_plan.h"

namespace pt {

/// Before anything is chosen. Throws Error.
void check_options_for_scene(const Options& options, const SceneProperties& scene);

/// What was chosen, with the options. Throws Error.
void check_plan(const ExecutionPlan& plan, const Options& options, const SceneProperties& scene,
                const DeviceProperties& device);

}  // namespace pt
