// What can be chosen about sampling when the program runs: the vocabulary that options and physics
// share.
#pragma once

#include "common/platform/platform.h"

namespace pt {

/// Where the numbers of a path come from that depend on (seed, pixel, sample, block) alone.
enum class SamplerKind : std::uint8_t { independent, stratified, sobol };

/// How the direction in which a path continues is sampled.
enum class DirectionSampling : std::uint8_t { uniform, cosine, bsdf };

/// How light sampling and direction sampling are combined.
enum class MisHeuristic : std::uint8_t { none, balance, power };

}  // namespace pt
