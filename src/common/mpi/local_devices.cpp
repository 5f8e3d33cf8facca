#include "common/mpi/local_devices.h"

namespace pt {

std::vector<int> local_devices(int local_rank, int local_ranks, int gpu_count) {
  if (gpu_count <= 0) return {};
  if (local_ranks >= gpu_count) return {local_rank % gpu_count};
  std::vector<int> ordinals;
  const int end = (local_rank + 1) * gpu_count / local_ranks;
  for (int i = local_rank * gpu_count / local_ranks; i < end; ++i) ordinals.push_back(i);
  return ordinals;
}

}  // namespace pt
