// The devices of a render.
#pragma once

#include <vector>

#include "app/options/check_options.h"
#include "common/device/devices.h"
#include "common/mpi/ranks.h"

namespace pt {

/// Finds the devices for the options, which then name these. `ranks`: of a job, whose ranks share
/// them; may be null. Throws Error where a device is not there, or where a given option has no
/// effect on it.
std::vector<DeviceInfo> choose_render_devices(Options& options, const GivenOptions& given,
                                              const Ranks* ranks = nullptr);

}  // namespace pt
