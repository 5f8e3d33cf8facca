// Rays that the CPU traces together, as arrays.
#pragma once

#include "common/geometry/ray.h"

namespace pt {

struct RayBlock {
  static constexpr std::uint32_t size_max = 32;
  static constexpr std::uint32_t lanes_max = 16;  ///< of what tests several rays at once

  std::uint32_t count = 0;
  alignas(64) float origin[3][size_max];
  float direction[3][size_max];
  float t_max[size_max];  ///< hits count for 0 < t < t_max: 0 or less for a ray that meets nothing
  std::uint32_t
      key[size_max];  ///< for masks (transport/mask.h); read only in scenes that have them

  void append(const Ray& ray, float ray_t_max, std::uint32_t ray_key = 0) {
    key[count] = ray_key;
    for (int i = 0; i < 3; ++i) {
      origin[i][count] = ray.origin[i];
      direction[i][count] = ray.direction[i];
    }
    t_max[count++] = ray_t_max;
  }

  /// Fills the last lanes up with rays that meet nothing.
  void fill_lanes() {
    const std::uint32_t rays = count;
    while (count % lanes_max != 0) append({Vec3(0.0f), Vec3(0.0f, 0.0f, 1.0f)}, -1.0f);
    count = rays;
  }

  Ray ray(std::uint32_t i) const {
    return {{origin[0][i], origin[1][i], origin[2][i]},
            {direction[0][i], direction[1][i], direction[2][i]}};
  }
};

/// The nearest hits of a block's rays; for one that meets nothing `primitive` is no_primitive and
/// `t` is anything.
struct HitBlock {
  alignas(64) float t[RayBlock::size_max];
  std::uint32_t primitive[RayBlock::size_max];
};

}  // namespace pt
