#include "common/mpi/local_devices.h"

#include <algorithm>

namespace pt {

std::vector<int> local_devices(int local_rank, int local_ranks, int gpu_count) {
  if (gpu_count <= 0) return {};
  if (local_ranks >= gpu_count) return {local_rank % gpu_count};
  std::vector<int> ordinals;
  const int end = (local_rank + 1) * gpu_count / local_ranks;
  for (int i = local_rank * gpu_count / local_ranks; i < end; ++i) ordinals.push_back(i);
  return ordinals;
}

std::vector<int> local_devices(int local_rank, const std::vector<std::vector<std::string>>& seen) {
  const auto& own = seen[local_rank];
  const auto first = seen.begin();
  return local_devices(static_cast<int>(std::count(first, first + local_rank, own)),
                       static_cast<int>(std::count(first, seen.end(), own)),
                       static_cast<int>(own.size()));
}

}  // namespace pt
