// Markov chains over paths and the image that they add up to, in a device's memory
// (docs/metropolis.md). A batch traces one path of each chain; then every chain takes its step.
#pragma once

#include "common/film/film.h"
#include "common/sampling/chains.h"
#include "common/transport/metropolis.h"

namespace pt {

/// The path at which a chain is.
struct alignas(16) ChainState {
  Color radiance = Color(0.0f);
  float target = 0.0f;
};

/// Where on the image a chain is, and what it has not yet added there.
struct alignas(16) ChainSplat {
  double weight = 0.0;  ///< per radiance of its state
  std::uint32_t pixel = 0;
  std::uint32_t padding = 0;
};

/// Proposals by their kind, and those of them that were accepted.
struct ChainTally {
  std::uint64_t large = 0, large_accepted = 0;
  std::uint64_t small = 0, small_accepted = 0;
};

PT_HD ChainTally operator+(const ChainTally& a, const ChainTally& b) {
  return {a.large + b.large, a.large_accepted + b.large_accepted, a.small + b.small,
          a.small_accepted + b.small_accepted};
}

/// A sum of radiance in fixed point, three channels a pixel: integers add up to the same sum in any
/// order.
using SplatSum = std::uint64_t;

/// All arrays of the chains: a view of a device's memory.
struct ChainArrays {
  Chains* chains = nullptr;  ///< one
  Proposal* proposals = nullptr;
  Vec4* accepted = nullptr;
  ChainState* states = nullptr;
  ChainSplat* unsplatted = nullptr;
  SplatSum* sums = nullptr;     ///< [pixel of the window][channel]
  ChainTally* tally = nullptr;  ///< one

  /// make(pointer's type, count) for each.
  template <class Make>
  void for_each_array(std::uint64_t chain_count, std::uint64_t path_count, std::uint64_t blocks,
                      std::uint64_t pixels, Make&& make) {
    make(chains, 1);
    make(proposals, path_count);
    make(accepted, chain_count * blocks);
    make(states, chain_count);
    make(unsplatted, chain_count);
    make(sums, 3 * pixels);
    make(tally, 1);
  }
  static constexpr std::uint64_t bytes_per_chain(std::uint64_t blocks) {
    return blocks * sizeof(Vec4) + sizeof(ChainState) + sizeof(ChainSplat);
  }
};

/// What the chains do after a batch.
struct ChainStep {
  enum class Kind : std::uint8_t {
    none,    ///< the batch is of bootstrap paths
    start,   ///< it is of the paths at which the chains begin
    mutate,  ///< it is of their proposals
    finish   ///< nothing was traced: add what is not yet added
  };
  Kind kind = Kind::none;
  MutationWeights weights;
  double scale = 1.0;        ///< quanta of a SplatSum per radiance
  std::uint32_t blocks = 0;  ///< of random numbers that are stored at most
};

/// Blocks of random numbers of which a path of so many rays may have asked.
PT_HD std::uint32_t used_blocks(std::uint32_t rays) { return 2 * rays + 2; }

/// Adds radiance to a pixel by add(sum, quanta), which must be safe among threads.
template <class Add>
PT_HD void splat(const ChainArrays& arrays, const ChainStep& step, std::uint32_t pixel,
                 const Color& radiance, double weight, Add&& add) {
  for (int c = 0; c < 3; ++c) {
    const double quanta = floor(static_cast<double>(radiance[c]) * weight * step.scale + 0.5);
    if (quanta != 0.0) {
      add(&arrays.sums[std::uint64_t{3} * pixel + static_cast<std::uint32_t>(c)],
          static_cast<SplatSum>(static_cast<std::int64_t>(quanta)));
    }
  }
}

/// The chain makes the path its state: its numbers, as the path drew them, and where it is.
PT_HD void move_chain(const ChainArrays& arrays, const Chains& chains, const Proposal& proposal,
                      std::uint32_t blocks, std::uint32_t chain, const Color& radiance,
                      float target, std::uint32_t pixel) {
  // A block's place is the chain's, whoever's path it was: a bootstrap path has another number.
  for (std::uint32_t block = 0; block < blocks; ++block) {
    arrays.accepted[std::uint64_t{block} * chains.count + chain] =
        chains.draw(proposal.path, proposal.iteration, block);
  }
  store_wide(&arrays.states[chain], ChainState{radiance, target});
  arrays.unsplatted[chain].pixel = pixel;
}

/// One chain's step after `batch` (see ChainStep), and its next proposal. Adds to `paths` and
/// `tally`; `count(bin)` and `add` as in accumulate_pixel and splat.
template <class Count, class Add>
PT_HD void step_chain(const ChainArrays& arrays, const SampleBuffer& batch, const ChainStep& step,
                      std::uint32_t chain, PathTally& paths, ChainTally& tally, Count&& count,
                      Add&& add) {
  const Chains& chains = *arrays.chains;
  ChainSplat& unsplatted = arrays.unsplatted[chain];
  const ChainState state = load_wide(&arrays.states[chain]);
  if (step.kind == ChainStep::Kind::finish) {
    splat(arrays, step, unsplatted.pixel, state.radiance, unsplatted.weight, add);
    unsplatted.weight = 0.0;
    return;
  }
  const Sample sample = load_wide(&batch.samples[chain]);
  const bool finite = count_sample(sample, paths, count);
  const std::uint32_t rays = sample.rays & 0xffffu;

  Proposal proposal = load_wide(&arrays.proposals[chain]);
  const float target = finite ? chain_target(sample.radiance) : 0.0f;
  const std::uint32_t used = used_blocks(rays) < step.blocks ? used_blocks(rays) : step.blocks;
  const Vec4 camera = chains.draw(proposal.path, proposal.iteration, 0);
  const std::uint32_t pixel = chains.window.index_of(chains.window.point_of(camera).pixel);
  const bool starts = step.kind == ChainStep::Kind::start;
  const std::uint32_t iteration = starts ? 0 : proposal.iteration;
  const Vec2 decision = chains.decide(chain, iteration);
  bool accepted = starts;
  if (starts) {
    unsplatted.weight = 0.0;
  } else {
    const bool is_large = proposal.is_large != 0;
    const float a = target > 0.0f ? acceptance(state.target, target) : 0.0f;
    if (target > 0.0f) {
      splat(arrays, step, pixel, sample.radiance, step.weights.of_proposal(target, a, is_large),
            add);
    }
    const double weight = unsplatted.weight + step.weights.of_current(state.target, a);
    accepted = decision.x < a;
    if (accepted) splat(arrays, step, unsplatted.pixel, state.radiance, weight, add);
    unsplatted.weight = accepted ? 0.0 : weight;
    ++(is_large ? tally.large : tally.small);
    if (accepted) ++(is_large ? tally.large_accepted : tally.small_accepted);
  }
  if (accepted) {
    move_chain(arrays, chains, proposal, used, chain, sample.radiance, target, pixel);
    proposal.blocks = used;
  }
  proposal.path = chain;
  proposal.iteration = iteration + 1;
  proposal.is_large = decision.y < step.weights.large_step_probability ? 1 : 0;
  store_wide(&arrays.proposals[chain], proposal);
}

}  // namespace pt
