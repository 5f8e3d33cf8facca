// Several devices as one renderer, or one whose film is to be kept.
#pragma once

#include <memory>
#include <vector>

#include "common/device/devices.h"
#include "common/distribute/group_renderer.h"
#include "common/plan/execution_plan.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Whether the options ask for what one device's renderer alone cannot do.
bool needs_group(const Options& options, const std::vector<DeviceInfo>& devices);

/// A worker for each device and its plan, set up at the same time. `scene` must live as long and is
/// prepared. Throws what a device's renderer throws.
std::vector<std::unique_ptr<Worker>> make_workers(const std::vector<ExecutionPlan>& plans,
                                                  const SceneData& scene,
                                                  const std::vector<DeviceInfo>& devices,
                                                  ResultBell& bell);

/// The pixels of the options' part of the image: rows, every so many of them, so that parts take
/// about the same time. Throws Error where the image has too few rows.
std::vector<Window> part_windows(const Options& options);

}  // namespace pt
