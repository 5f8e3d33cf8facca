// What a scene or a device cannot have, whatever an option asks for.
#pragma once

#include "common/plan/execution_plan.h"
#include "common/plan/kernels.h"

namespace pt {

/// Before anything is chosen. Throws Error.
void check_options_for_scene(const Options& options, const SceneProperties& scene);

/// Which kernel a plan asks for; `on_cuda`: the device renders it, not a thread of the host.
KernelNeed need_of(const ExecutionPlan& plan, const Options& options, const SceneProperties& scene,
                   bool on_cuda);

/// What was chosen, with the options. Throws Error.
void check_plan(const ExecutionPlan& plan, const Options& options, const SceneProperties& scene,
                const DeviceProperties& device);

}  // namespace pt
