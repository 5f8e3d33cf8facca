// Devices of other ranks as workers of rank 0.
#pragma once

#include "common/distribute/worker.h"
#include "common/mpi/ranks.h"

namespace pt {

/// On rank 0, after announce(): a worker for each device of each other rank, of
/// Worker::least_paths() as said. `ranks` must outlive them; when they are destroyed the other
/// ranks' serve_units() return.
std::vector<std::unique_ptr<Worker>> remote_workers(Ranks& ranks, std::uint64_t least_paths = 1);

/// On the other ranks: hands rank 0's units to `workers`, as many as devices were announced, and
/// their results back, until rank 0 has no more.
void serve_units(Ranks& ranks, const std::vector<std::unique_ptr<Worker>>& workers);

}  // namespace pt
