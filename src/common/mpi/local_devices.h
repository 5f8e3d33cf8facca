// Which of a machine's GPUs a rank takes.
#pragma once

#include <string>
#include <vector>

namespace pt {

/// The ordinals of the GPUs that rank `local_rank` of a machine's `local_ranks` takes of those that
/// all of them see: an equal share, or one that it shares with others where there are more ranks.
std::vector<int> local_devices(int local_rank, int local_ranks, int gpu_count);

/// The same where ranks may see different GPUs, as batch systems have it: [local rank][ordinal]
/// names the GPU itself (its PCI bus or UUID). Those that see the same divide them.
std::vector<int> local_devices(int local_rank, const std::vector<std::vector<std::string>>& seen);

}  // namespace pt
