// What the ranks of a job that is rendered together need of each other before they begin.
#pragma once

#include <string>
#include <vector>

#include "app/render/make_renderer.h"
#include "common/device/devices.h"
#include "common/mpi/ranks.h"

namespace pt {

/// The devices of this rank: those that the options name; of GPUs that they do not name one by one,
/// and of the CPU's threads, its share among the ranks of its machine.
std::vector<DeviceInfo> choose_rank_devices(Options& options, const RankInfo& rank);

/// Where the launcher has left half of the machine's processors idle or more, a sentence about it;
/// else none. Open MPI binds each of two ranks to one core unless it is told otherwise.
std::string binding_warning(const RankInfo& rank);

/// Collective. Throws Error, naming rank and what differs, unless all ranks have the same program,
/// options and kind of device.
void check_ranks(Ranks& ranks, const Options& options, const DeviceInfo& device);

/// Collective. load_scene of the same files on all ranks: the first one reads them, and the others
/// get their bytes, unless Options::scene_from_disk.
SceneData load_shared_scene(Ranks& ranks, const Options& options, const DeviceInfo& device,
                            const Warn& warn);

}  // namespace pt
