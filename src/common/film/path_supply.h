// Which path a mode traces under an index of its batch, and whether another one follows it.
#pragma once

#include "common/film/markov_chains.h"

namespace pt {

/// The paths of a batch. An index is one path or, with Markov chains, a sequence of paths, each of
/// which depends on the result of the one before it.
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
