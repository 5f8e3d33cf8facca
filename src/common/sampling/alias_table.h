// Choosing among many in constant time: the alias method (Walker 1977; Vose 1991).
//
// Every entry i holds 1 / n of the probability; the part below its threshold belongs to i itself,
// the rest to one other entry, its alias.
#pragma once

#include <span>
#include <vector>

#include "common/math/vec.h"

namespace pt {

/// One 8-byte load.
struct alignas(8) AliasEntry {
  float threshold = 1.0f;   ///< in [0, 1]
  std::uint32_t alias = 0;  ///< index of the other entry
};

/// What was chosen, and the randomness that the choice has left over.
struct AliasSample {
  std::uint32_t index;
  float u;  ///< again uniform in [0, 1), independent of the index
};

/// Decides between entry `index` and its alias by `u` in [0, 1). An entry of weight zero has
/// threshold 0 and is never returned.
PT_HD AliasSample resolve_alias(const AliasEntry* entries, std::uint32_t index, float u) {
  const AliasEntry entry = entries[index];
  const float t = entry.threshold;
  const bool own = u < t;
  const float rest = own ? divide(u, t) : divide(u - t, 1.0f - t);
  return {own ? index : entry.alias, fminf(rest, one_minus_ulp)};
}

/// For at most a few thousand entries, as one float of 24 random bits has to name the entry and the
/// position in it.
PT_HD AliasSample sample_alias(const AliasEntry* entries, std::uint32_t count, float u) {
  const float scaled = u * static_cast<float>(count);
  const auto floor = static_cast<std::uint32_t>(scaled);
  const std::uint32_t index = floor < count ? floor : count - 1;
  return resolve_alias(entries, index,
                       fminf(fmaxf(scaled - static_cast<float>(index), 0.0f), one_minus_ulp));
}

/// For up to 2^32 - 1 entries, from the 48 random bits of two floats that are multiples of 2^-24 in
/// [0, 1); the position in the entry keeps 24 of them.
PT_HD AliasSample sample_alias(const AliasEntry* entries, std::uint32_t count, float u0, float u1) {
  const auto high = static_cast<std::uint64_t>(u0 * 16777216.0f) * count;
  const auto low = static_cast<std::uint64_t>(u1 * 16777216.0f) * count;
  const std::uint64_t position = high + (low >> 24);  // count * u in steps of 2^-24
  return resolve_alias(entries, static_cast<std::uint32_t>(position >> 24),
                       static_cast<float>(position & 0xffffffu) * half_ulp);
}

/// The table with probabilities weight / sum, in time O(n). Throws Error naming the first weight
/// that is negative or not finite, or when there are none, more than 2^32 - 1, or all are zero.
std::vector<AliasEntry> build_alias_table(std::span<const float> weights);

}  // namespace pt
