// The ranks of a job agree on devices, options and scene before they render together.
#pragma once

#include <string>
#include <vector>

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

}  // namespace pt
