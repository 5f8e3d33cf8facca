// Which path a mode traces under an index of its batch, and whether another one follows it.
#pragma once

#include "common/film/markov_chains.h"

namespace pt {

/// Of a batch. An index is one path; or one after the other, where a path depends on what the one
/// before it found. What that is about, a mode does not know.
struct PathSupply {
  const ChainRun* chains = nullptr;  ///< in the device's memory; null: an index is one path

  PT_HD bool repeats() const { return chains != nullptr; }

  /// Where paths repeat: takes the result of the index's last path, if there is one, and returns
  /// whether a path is to be traced. `samples`: [index], of no rays before the first path.
  PT_HD bool next(Sample* samples, std::uint32_t index) const {
    return continue_chain(*chains, samples, index);
  }

  friend bool operator==(const PathSupply&, const PathSupply&) = default;
};

}  // namespace pt
