// The state of a path between two stages.
#pragma once

#include "common/geometry/ray.h"
#include "common/light/receiver.h"
#include "common/medium/distance_sampling.h"
#include "common/medium/medium.h"

namespace pt {

PT_HD std::uint32_t pack_pixel(std::uint32_t x, std::uint32_t y) { return x | y << 16; }
PT_HD std::uint32_t pixel_x(std::uint32_t pixel) { return pixel & 0xffffu; }
PT_HD std::uint32_t pixel_y(std::uint32_t pixel) { return pixel >> 16; }

/// A path among media; only in scenes that have any.
struct PathMedium {
  std::uint16_t around = no_medium;  ///< where its current ray begins (Media)
  std::uint16_t passed = 0;          ///< surfaces without a BSDF that it has gone through
  float travelled = 0.0f;            ///< from where it has its direction to where the ray begins
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

  static constexpr float delta_distribution = HUGE_VALF;  ///< not found by light sampling

  /// Rays that max_depth counts.
  template <class Traits>
  PT_HD std::uint32_t depth() const {
    if constexpr (Traits::has_media) return std::uint32_t{rays} - medium.passed;
    return rays;
  }

  PT_HD std::uint32_t packed_rays() const { return rays | std::uint32_t{shadow_rays} << 16; }
};

}  // namespace pt
