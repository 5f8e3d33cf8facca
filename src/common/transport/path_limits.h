// When a path ends, and whether light sampling is used.
#pragma once

#include "common/choices/choices.h"
#include "common/math/vec.h"

namespace pt {

struct PathLimits {
  std::uint32_t max_depth = 50;      ///< rays of a path, the camera ray included
  std::uint32_t roulette_depth = 0;  ///< from so many rays on Russian roulette decides; 0: never
  bool ask_lights = true;            ///< next-event estimation
  DirectionSampling directions = DirectionSampling::bsdf;
  MisHeuristic mis = MisHeuristic::power;

  /// Whether a path that has traced `rays` takes part in the roulette.
  PT_HD bool is_roulette(std::uint32_t rays) const {
    return roulette_depth != 0 && rays >= roulette_depth;
  }
};

/// Russian roulette (pbrt-v4, section 2.2.4): a path of low throughput ends, or its weight grows by
/// the inverse of the probability to continue. `u` in [0, 1) decides. The probability is at most
/// 0.95, so that no path between perfect mirrors lives for ever. It depends on eta_scale * beta:
/// for a path in glass, its beta outside. The surface alone gives eta_scale, so that a path need
/// not store it. (Where the path hits something else inside, the probability is smaller than
/// needed; the mean is the same.)
PT_HD void play_roulette(Color& beta, float u, float eta_scale = 1.0f) {
  const float survival = fminf(fmaxf(fmaxf(beta.x, beta.y), beta.z) * eta_scale, 0.95f);
  const float scale = u < survival ? divide(1.0f, survival) : 0.0f;
  beta = multiply_rounded(beta, Color(scale));
}

}  // namespace pt
