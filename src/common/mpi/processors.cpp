#include "common/mpi/processors.h"

#include <sched.h>

#include <algorithm>
#include <cstring>

namespace pt {
namespace {

static_assert(ProcessorSet{}.size() <= CPU_SETSIZE);

ProcessorSet to_set(const cpu_set_t& mask) {
  ProcessorSet set;
  for (std::size_t i = 0; i < set.size(); ++i) set[i] = CPU_ISSET(i, &mask);
  return set;
}

}  // namespace

ProcessorSet own_processors() {
  cpu_set_t mask;
  if (::sched_getaffinity(0, sizeof mask, &mask) != 0) return {};
  return to_set(mask);
}

ProcessorSet free_processors() {
  cpu_set_t own, all;
  if (::sched_getaffinity(0, sizeof own, &own) != 0) return {};
  std::memset(&all, 0xff, sizeof all);
  // The kernel takes those that there are and that the job may use.
  if (::sched_setaffinity(0, sizeof all, &all) != 0) return to_set(own);
  const ProcessorSet free = own_processors();
  ::sched_setaffinity(0, sizeof own, &own);
  return free;
}

int processor_share(std::span<const ProcessorSet> ranks, int local_rank) {
  const ProcessorSet& mine = ranks[local_rank];
  double share = 0;
  for (std::size_t i = 0; i < mine.size(); ++i) {
    if (mine[i])
      share += 1.0 / std::ranges::count_if(ranks, [&](const ProcessorSet& set) { return set[i]; });
  }
  return std::max(1, static_cast<int>(share + 1e-6));  // three thirds are one
}

int idle_processors(std::span<const ProcessorSet> ranks, const ProcessorSet& free) {
  ProcessorSet used;
  for (const ProcessorSet& set : ranks) used |= set;
  return used.none() ? 0 : static_cast<int>((free & ~used).count());
}

std::vector<int> local_devices(int local_rank, int local_ranks, int gpu_count) {
  if (gpu_count <= 0) return {};
  if (local_ranks >= gpu_count) return {local_rank % gpu_count};
  std::vector<int> ordinals;
  const int end = (local_rank + 1) * gpu_count / local_ranks;
  for (int i = local_rank * gpu_count / local_ranks; i < end; ++i) ordinals.push_back(i);
  return ordinals;
}

}  // namespace pt
