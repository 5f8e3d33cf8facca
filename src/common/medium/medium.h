// A participating medium: what absorbs, scatters and emits light between surfaces.
#pragma once

#include "common/medium/phase_function.h"
#include "common/medium/volume_grid.h"

namespace pt {

/// No medium: a vacuum.
inline constexpr std::uint32_t no_medium = 0xffffu;

/// 64 bytes: four loads.
struct alignas(16) Medium {
  Color extinction = Color(0.0f);  ///< sigma_t >= 0, per unit of length, where the density is 1
  PhaseKind phase{};
  Color albedo = Color(0.0f);  ///< sigma_s / sigma_t, in [0, 1]
  float phase_parameter = 0.0f;
  Color emission = Color(0.0f);  ///< radiance of what absorbs, W / (m^2 sr): a unit of length adds
                                 ///< sigma_a times as much
  // Grids whose values the above are multiplied by, or no_grid:
  std::uint32_t density_grid = no_grid;  ///< of the extinction; >= 0
  std::uint32_t albedo_grid = no_grid;
  std::uint32_t emission_grid = no_grid;
  std::uint32_t unused[2] = {};

  PT_HD bool is_homogeneous() const { return density_grid == no_grid; }
};

/// The media on both sides of a surface: where its normal points, and behind.
struct MediumBoundary {
  std::uint16_t outside = no_medium, inside = no_medium;

  /// Behind the surface, as seen by who travels along `direction` away from it.
  PT_HD std::uint16_t towards(const Vec3& direction, const Vec3& normal) const {
    return dot(direction, normal) > 0.0f ? outside : inside;
  }
  bool operator==(const MediumBoundary&) const = default;
};

/// The medium's albedo at a point.
PT_HD Color albedo_at(const VolumeGrids& grids, const Medium& medium, const Vec3& point) {
  if (medium.albedo_grid == no_grid) return medium.albedo;
  return multiply_rounded(medium.albedo,
                          sample_grid(grids, grids.grids[medium.albedo_grid], point));
}

/// The radiance of what absorbs there.
PT_HD Color emission_at(const VolumeGrids& grids, const Medium& medium, const Vec3& point) {
  if (medium.emission_grid == no_grid) return medium.emission;
  return multiply_rounded(medium.emission,
                          sample_grid(grids, grids.grids[medium.emission_grid], point));
}

/// exp(-extinction * length); `length` may be infinite_distance.
PT_HD Color transmittance(const Color& extinction, float length) {
  return {expf(-multiply_rounded(extinction.x, length)),
          expf(-multiply_rounded(extinction.y, length)),
          expf(-multiply_rounded(extinction.z, length))};
}

}  // namespace pt
