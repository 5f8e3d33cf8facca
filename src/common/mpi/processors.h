// Which of a machine's processors a rank may use, which part of them is its own, and which GPUs.
#pragma once

#include <bitset>
#include <span>
#include <vector>

namespace pt {

/// By number. No processor: it is not known.
using ProcessorSet = std::bitset<1024>;

/// The processors that this thread may use: what its launcher has bound it to.
ProcessorSet own_processors();
/// The processors that it could use, were it not bound: the machine's, or those of its job's part
/// of it.
ProcessorSet free_processors();

/// How many of its processors rank `local_rank` has for itself, where ranks that may use the same
/// one share it evenly; rounded down, at least 1. `ranks`: [local rank].
int processor_share(std::span<const ProcessorSet> ranks, int local_rank);
/// How many of `free` no rank may use.
int idle_processors(std::span<const ProcessorSet> ranks, const ProcessorSet& free);

/// The ordinals of the GPUs that rank `local_rank` of a machine's `local_ranks` takes of those that
/// all of them see: an equal share, or one that it shares with others where there are more ranks.
std::vector<int> local_devices(int local_rank, int local_ranks, int gpu_count);

}  // namespace pt
