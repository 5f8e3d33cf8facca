// The devices of a render and, in a job of several ranks, what these need of each other first.
#pragma once

#include <string>
#include <vector>

#include "app/options/check_options.h"
#include "app/render/make_renderer.h"
#include "common/device/devices.h"
#include "common/mpi/ranks.h"

namespace pt {

/// The devices of this rank: those that the options name one by one, else its share of the
/// machine's GPUs or CPU threads.
std::vector<DeviceInfo> choose_rank_devices(Options& options, const RankInfo& rank);

/// A warning if the launcher leaves at least half of the machine's processors idle, else empty.
/// Open MPI by default binds each of two ranks to one core.
std::string binding_warning(const RankInfo& rank);

/// Collective. Throws Error, naming rank and what differs, unless all ranks have the same program,
/// options and kind of device.
void check_ranks(Ranks& ranks, const Options& options, const DeviceInfo& device);

/// Collective. load_scene of the same files on all ranks: the first one reads them, and the others
/// get their bytes, unless Options::scene_from_disk.
SceneData load_shared_scene(Ranks& ranks, const Options& options, const DeviceInfo& device,
                            const Warn& warn);

/// Finds the devices for the options, which then name these. `ranks`: of a job, whose ranks share
/// them; may be null. Throws Error where a device is not there, or where a given option has no
/// effect on it.
std::vector<DeviceInfo> choose_render_devices(Options& options, const GivenOptions& given,
                                              const Ranks* ranks = nullptr);

}  // namespace pt
