// Which of a machine's processors a rank may use, and which part of them is its own.
#pragma once

#include <bitset>
#include <span>

namespace pt {

/// By number. No processor: it is not known.
using ProcessorSet = std::bitset<1024>;

/// Those that this thread may use: what its launcher has bound it to.
ProcessorSet own_processors();
/// Those that it could use, were it not bound: of the machine, or of its job's part of it.
ProcessorSet free_processors();

/// How many of its processors rank `local_rank` has for itself, where ranks that may use the same
/// one share it evenly; rounded down, at least 1. `ranks`: [local rank].
int processor_share(std::span<const ProcessorSet> ranks, int local_rank);
/// How many of `free` no rank may use.
int idle_processors(std::span<const ProcessorSet> ranks, const ProcessorSet& free);

}  // namespace pt
