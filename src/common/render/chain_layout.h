// What Markov chains take of a device's memory, and how their paths look as a batch.
#pragma once

#include "common/options/options.h"
#include "common/render/metropolis.h"

namespace pt {

struct ChainLayout {
  ChainPlan plan;
  std::uint64_t pixels = 0;  ///< of the largest film
  Sample* samples = nullptr;
  std::uint64_t seed = 0;
  MutationSize mutation_size;

  /// Calls make(pointer to set, count) for each array of the chains.
  template <class Make>
  void make_arrays(ChainArrays& arrays, Make&& make) const {
    arrays.for_each_array(plan.chains, plan.batch_paths(), plan.bootstrap, plan.blocks, pixels,
                          make);
  }
  /// The chains as what draws their paths' numbers sees them.
  Chains view(const ChainArrays& arrays, const ChainWindow& window) const {
    return {arrays.proposals, arrays.accepted, seed, static_cast<std::uint32_t>(plan.chains),
            mutation_size,    window};
  }
  /// A path's index is its name. --work pixel and sample see a row of pixels.
  SampleBuffer batch(std::uint32_t paths) const { return {samples, Window{0, 0, paths, 1}, 0, 1}; }
};

/// The number of sums in the film that chains walk over.
inline std::uint64_t sum_count(const ChainWindow& window) {
  return std::uint64_t{3} * window.width * window.height;
}

}  // namespace pt
