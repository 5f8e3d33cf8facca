// Markov chains over paths and the image that they add up to, in a device's memory
// (docs/design/metropolis.md). When a chain's path has been traced the chain takes a step.
#pragma once

#include "common/film/bootstrap.h"
#include "common/film/film.h"
#include "common/transport/metropolis.h"

namespace pt {

/// A chain's current state, a path.
struct alignas(16) ChainState {
  Color radiance = Color(0.0f);  ///< W / (m^2 sr)
  float target = 0.0f;           ///< its luminance, see target_of
};

/// The pixel of a chain's state, and the weight that is not yet added to it.
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

/// Counts of the chains' work. The counters exist in several copies, so that threads seldom contend
/// for one.
struct ChainCounts {
  static constexpr std::uint32_t copies = 1024;
  PathTally paths;
  ChainTally steps;
};

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
  SplatSum* sums = nullptr;       ///< [pixel of the window][channel]
  ChainCounts* counts = nullptr;  ///< [ChainCounts::copies]
  Bootstrap bootstrap;

  /// make(pointer's type, count) for each.
  template <class Make>
  void for_each_array(std::uint64_t chain_count, std::uint64_t path_count,
                      std::uint64_t bootstrap_paths, std::uint64_t blocks, std::uint64_t pixels,
                      Make&& make) {
    make(chains, 1);
    make(proposals, path_count);
    make(accepted, chain_count * blocks);
    make(states, chain_count);
    make(unsplatted, chain_count);
    make(sums, 3 * pixels);
    make(counts, ChainCounts::copies);
    bootstrap.for_each_array(bootstrap_paths, make);
  }
  static constexpr std::uint64_t bytes_per_chain(std::uint64_t blocks) {
    return blocks * sizeof(Vec4) + sizeof(ChainState) + sizeof(ChainSplat);
  }
};

/// The step that chains take with the paths that have been traced.
struct ChainStep {
  enum class Kind : std::uint8_t {
    start,   ///< begin at them
    mutate,  ///< accept them or not
    finish   ///< no path was traced: add what is not yet added
  };
  Kind kind = Kind::start;
  MutationWeights weights;
  double scale = 1.0;        ///< quanta of a SplatSum per radiance
  std::uint32_t blocks = 0;  ///< of random numbers that are stored at most
};

/// Asynchronous chains: each traces and mutates until it has taken `last` steps since
/// its start, and waits for no other.
struct ChainRun {
  ChainArrays arrays;
  ChainStep step;
  std::uint32_t last = 0;
};

/// The most blocks of random numbers that a path of so many rays may have drawn.
PT_HD std::uint32_t used_blocks(std::uint32_t rays) { return 2 * rays + 2; }

/// Adds radiance to a pixel.
PT_HD void splat(const ChainArrays& arrays, const ChainStep& step, std::uint32_t pixel,
                 const Color& radiance, double weight) {
  for (int c = 0; c < 3; ++c) {
    const double quanta = floor(static_cast<double>(radiance[c]) * weight * step.scale + 0.5);
    if (quanta != 0.0) {
      atomic_add(&arrays.sums[std::uint64_t{3} * pixel + static_cast<std::uint32_t>(c)],
                 static_cast<SplatSum>(static_cast<std::int64_t>(quanta)));
    }
  }
}

/// The target of a path that was traced; 0 for NaN.
PT_HD float target_of(const Sample& sample) {
  return is_finite(sample.radiance) ? chain_target(sample.radiance) : 0.0f;
}

/// A bootstrap path adds its share to the image; `proposal` is its own.
PT_HD void splat_bootstrap(const ChainArrays& arrays, const ChainStep& step,
                           const Proposal& proposal, const Sample& sample) {
  const float target = target_of(sample);
  if (!(target > 0.0f)) return;
  const Chains& chains = *arrays.chains;
  const Vec4 camera = chains.draw(proposal.path, proposal.iteration, 0);
  splat(arrays, step, chains.window.index_of(chains.window.point_of(camera).pixel), sample.radiance,
        step.weights.of_bootstrap(target));
}

/// The chain makes the path its state: its numbers, as the path drew them, and where it is.
PT_HD void move_chain(const ChainArrays& arrays, const Chains& chains, const Proposal& proposal,
                      std::uint32_t blocks, std::uint32_t chain, const Color& radiance,
                      float target, std::uint32_t pixel) {
  // Blocks are stored at the chain's index: a bootstrap path's own index differs.
  for (std::uint32_t block = 0; block < blocks; ++block) {
    arrays.accepted[std::uint64_t{block} * chains.count + chain] =
        chains.draw(proposal.path, proposal.iteration, block);
  }
  store_wide(&arrays.states[chain], ChainState{radiance, target});
  arrays.unsplatted[chain].pixel = pixel;
}

/// Counts a finished path.
PT_HD void count_path(const Sample& sample, ChainCounts& counts) {
  PathTally one;
  count_sample(sample, one, [&](int bin) { atomic_add(&counts.paths.lengths[bin], 1); });
  atomic_add(&counts.paths.rays, one.rays);
  if (one.shadow_rays > 0) atomic_add(&counts.paths.shadow_rays, one.shadow_rays);
  if (one.nonfinite > 0) atomic_add(&counts.paths.nonfinite, 1);
}

PT_HD void count_step(bool is_large, bool accepted, ChainTally& steps) {
  atomic_add(is_large ? &steps.large : &steps.small, 1);
  if (accepted) atomic_add(is_large ? &steps.large_accepted : &steps.small_accepted, 1);
}

/// A chain adds what its state has not yet added.
PT_HD void finish_chain(const ChainArrays& arrays, const ChainStep& step, std::uint32_t chain) {
  ChainSplat& unsplatted = arrays.unsplatted[chain];
  splat(arrays, step, unsplatted.pixel, load_wide(&arrays.states[chain]).radiance,
        unsplatted.weight);
  unsplatted.weight = 0.0;
}

/// One chain's step (start or mutate) after the path that it proposed, of which `sample` is left,
/// and its next proposal.
PT_HD void step_chain(const ChainArrays& arrays, const ChainStep& step, std::uint32_t chain,
                      const Sample& sample) {
  const Chains& chains = *arrays.chains;
  ChainCounts& counts = arrays.counts[chain % ChainCounts::copies];
  ChainSplat& unsplatted = arrays.unsplatted[chain];
  const ChainState state = load_wide(&arrays.states[chain]);
  count_path(sample, counts);
  const std::uint32_t rays = sample.rays & 0xffffu;

  Proposal proposal = load_wide(&arrays.proposals[chain]);
  const float target = target_of(sample);
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
      splat(arrays, step, pixel, sample.radiance, step.weights.of_proposal(target, a, is_large));
    }
    const double weight = unsplatted.weight + step.weights.of_current(state.target, a);
    accepted = decision.x < a;
    if (accepted) splat(arrays, step, unsplatted.pixel, state.radiance, weight);
    unsplatted.weight = accepted ? 0.0 : weight;
    count_step(is_large, accepted, counts.steps);
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

/// Lets a chain take the step that its traced path proposes, if there is one, and returns whether
/// it has a next path to trace. `samples`: [chain], of no rays where no path has been traced, which
/// they are when a run begins and again when it ends.
PT_HD bool continue_chain(const ChainRun& run, Sample* samples, std::uint32_t chain) {
  const Sample sample = load_wide(&samples[chain]);
  if (sample.rays > 0) {
    step_chain(run.arrays, run.step, chain, sample);
    store_wide(&samples[chain], Sample{});
  }
  return run.arrays.proposals[chain].iteration <= run.last;
}

/// Which path a mode traces under an index of its batch. An index is one path, or a chain of them
/// where a path depends on what the one before it found; a mode does not know what for.
struct PathSupply {
  const ChainRun* chains = nullptr;  ///< in the device's memory; null: an index is one path

  PT_HD bool has_chains() const { return chains != nullptr; }

  /// With chains: takes the result of the index's last path, if there is one, and returns
  /// whether a path is to be traced. `samples`: [index], of no rays before the first path.
  PT_HD bool next(Sample* samples, std::uint32_t index) const {
    return continue_chain(*chains, samples, index);
  }

  friend bool operator==(const PathSupply&, const PathSupply&) = default;
};

}  // namespace pt
