// Hashes: random numbers by name, for decisions that no sampler's pattern serves.
#pragma once

#include "common/platform/platform.h"

namespace pt {

/// Mixes `value` into a hash; the finalizer is Murmur3's (Appleby 2011).
PT_HD std::uint32_t combine_hash(std::uint32_t hash, std::uint32_t value) {
  hash = (hash ^ value) + 0x9e3779b9u;
  hash = (hash ^ hash >> 16) * 0x85ebca6bu;
  hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
  return hash ^ hash >> 16;
}

}  // namespace pt
