// Which of a machine's GPUs a rank takes.
#pragma once

#include <vector>

namespace pt {

/// The ordinals of the GPUs that rank `local_rank` of a machine's `local_ranks` takes of those that
/// all of them see: an equal share, or one that it shares with others where there are more ranks.
std::vector<int> local_devices(int local_rank, int local_ranks, int gpu_count);

}  // namespace pt
