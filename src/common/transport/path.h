// The state of a path between two stages.
#pragma once

#include "common/choices/choices.h"
#include "common/geometry/ray.h"
#include "common/light/receiver.h"
#include "common/math/vec.h"
#include "common/medium/distance_sampling.h"
#include "common/medium/medium.h"

namespace pt {

PT_HD std::uint32_t pack_pixel(std::uint32_t x, std::uint32_t y) { return x | y << 16; }
PT_HD std::uint32_t pixel_x(std::uint32_t pixel) { return pixel & 0xffffu; }
PT_HD std::uint32_t pixel_y(std::uint32_t pixel) { return pixel >> 16; }

/// A path among media; only in scenes that have any.
struct PathMedium {
  std::uint16_t id = no_medium;           ///< where its current ray begins (Media)
  std::uint16_t interface_crossings = 0;  ///< surfaces without a BSDF that it has gone through
  float travelled = 0.0f;  ///< from where it has its direction to where the ray begins
  ChannelDensities densities;
};

struct PathState {
  Color beta = Color(1.0f);  ///< throughput: product of f |cos| / pdf so far
  std::uint32_t index = 0;   ///< of the path in the batch: gives its pixel and sample
  std::uint16_t rays = 0;    ///< traced so far, the camera ray included
  std::uint16_t shadow_rays = 0;
  float bsdf_pdf = delta_distribution;  ///< density that chose the current ray, for MIS

  Receiver receiver;  ///< where the current ray begins; only where light selection depends on it

  PathMedium medium;

  float time = 0.0f;  ///< in the shutter's interval; only in scenes that move, and in no slot

  static constexpr float delta_distribution = HUGE_VALF;  ///< not found by light sampling

  /// Rays that max_depth counts.
  template <class Traits>
  PT_HD std::uint32_t depth() const {
    if constexpr (Traits::has_media) return std::uint32_t{rays} - medium.interface_crossings;
    return rays;
  }

  PT_HD std::uint32_t packed_rays() const { return rays | std::uint32_t{shadow_rays} << 16; }
};

struct PathSettings {
  std::uint32_t max_depth = 50;      ///< rays of a path, the camera ray included
  std::uint32_t roulette_depth = 0;  ///< from so many rays on Russian roulette decides; 0: never
  bool nee = true;                   ///< next-event estimation
  DirectionSampling directions = DirectionSampling::bsdf;
  MisHeuristic mis = MisHeuristic::power;
  std::uint32_t extra_records = 0;  ///< of each path (extra_state.h)

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
  beta *= Color(scale);
}

}  // namespace pt
