// The kernels around the paths of Markov chains: of their bootstrap, of their start and end, and of
// steps that all chains take together, where they are not asynchronous. A thread per path, chain or
// group; blocks of at most 1024. Seen from C++, a kernel is the function that launches it.
#pragma once

#include <cuda_runtime_api.h>

#include "common/device/cuda/stage_clock.h"
#include "common/film/markov_chains.h"

namespace pt {

/// Proposes the bootstrap paths [first, first + count).
__global__ void propose_bootstrap(Proposal* proposals, std::uint32_t first, std::uint32_t count,
                                  StageClock* clock);

/// Counts the paths of the batch, and keeps their targets: `targets` points to the first one's.
__global__ void keep_targets(float* targets, const __grid_constant__ SampleBuffer batch,
                             PathTally* tally, StageClock* clock);

/// Adds the bootstrap paths of the batch to the sums.
__global__ void splat_bootstrap_paths(const __grid_constant__ ChainArrays arrays,
                                      const __grid_constant__ SampleBuffer batch,
                                      const __grid_constant__ ChainStep step, StageClock* clock);

/// Sums the groups of the first `paths` targets.
__global__ void sum_groups(const __grid_constant__ Bootstrap bootstrap, std::uint32_t paths,
                           StageClock* clock);

/// Proposes the paths at which the chains begin.
__global__ void propose_starts(const __grid_constant__ ChainArrays arrays,
                               const __grid_constant__ ChainPositions positions, StageClock* clock);

/// ChainStep::Kind::start and mutate: the batch has a path of each chain.
__global__ void step_chains(const __grid_constant__ ChainArrays arrays,
                            const __grid_constant__ SampleBuffer batch,
                            const __grid_constant__ ChainStep step, StageClock* clock);

/// ChainStep::Kind::finish.
__global__ void finish_all_chains(const __grid_constant__ ChainArrays arrays, std::uint32_t chains,
                                  const __grid_constant__ ChainStep step, StageClock* clock);

}  // namespace pt
