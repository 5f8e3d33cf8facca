// A participating medium: it absorbs, scatters and emits light between surfaces.
#pragma once

#include "common/medium/phase_function.h"
#include "common/medium/volume_grid.h"

namespace pt {

/// No medium: a vacuum.
inline constexpr std::uint32_t no_medium = 0xffffu;

/// The most media in a scene in which they may overlap.
inline constexpr std::size_t overlapping_media_max = 16;

/// 64 bytes: four loads.
struct alignas(16) Medium {
  Color extinction = Color(0.0f);  ///< sigma_t >= 0, per unit of length, where the density is 1
  PhaseKind phase{};
  Color albedo = Color(0.0f);  ///< sigma_s / sigma_t, in [0, 1]
  float phase_parameter = 0.0f;
  Color emission = Color(0.0f);  ///< radiance of the absorbing matter, W / (m^2 sr): a unit of
                                 ///< length adds sigma_a times as much
  // Grids that multiply the above, or no_grid:
  std::uint32_t density_grid = no_grid;  ///< of the extinction; >= 0
  std::uint32_t albedo_grid = no_grid;
  std::uint32_t emission_grid = no_grid;
  std::int32_t priority = 0;  ///< where shapes overlap, the medium of highest priority fills them
  std::uint32_t unused = 0;

  PT_HD bool is_homogeneous() const { return density_grid == no_grid; }
};

/// The media on both sides of a surface: where its normal points, and behind.
struct MediumBoundary {
  std::uint16_t outside = no_medium, inside = no_medium;

  /// The medium of a path that leaves the surface along `direction`.
  PT_HD std::uint16_t towards(const Vec3& direction, const Vec3& normal) const {
    return dot(direction, normal) > 0.0f ? outside : inside;
  }
  bool operator==(const MediumBoundary&) const = default;
};

/// The media of a scene. The medium at a point is a number of 16 bits: an index or, where media may
/// overlap (Schmidt and Budge 2002, 'Simple Nested Dielectrics in Ray Traced Images'), a set of
/// them in the order of their priorities: bit i is 0 within a shape of medium i. In either case
/// no_medium is a vacuum.
struct Media {
  const Medium* list = nullptr;
  const MediumBoundary* boundaries = nullptr;  ///< [material]
  bool overlap = false;                        ///< the medium at a point is a set
  bool are_present = true;                     ///< false: boundaries and panes are not, either

  /// `medium_id` is not no_medium.
  PT_HD const Medium* at(std::uint32_t medium_id) const {
    return list + (overlap ? highest_bit(inverted(medium_id)) : medium_id);
  }

  /// The sides of a surface in `medium_id` that is not a boundary.
  PT_HD MediumBoundary same_on_both_sides(std::uint16_t medium_id) const {
    if (overlap) return {};
    return {medium_id, medium_id};
  }

  /// The medium of a path that arrived in `medium_id` and leaves a surface along `direction`.
  PT_HD std::uint16_t behind(const MediumBoundary& boundary, const Vec3& direction,
                             const Vec3& normal, std::uint16_t medium_id) const {
    if (!overlap) return boundary.towards(direction, normal);
    const std::uint32_t shape = bit_of(boundary);
    return static_cast<std::uint16_t>(dot(direction, normal) > 0.0f ? medium_id | shape
                                                                    : medium_id & ~shape);
  }

  /// Whether a surface lies in a medium of a higher priority than its own: then rays ignore it.
  PT_HD bool hides(std::uint32_t material, std::uint16_t medium_id) const {
    if (!overlap) return false;
    const std::uint32_t shape = bit_of(boundaries[material]);
    return shape != 0 && inverted(medium_id) >= 2 * shape;
  }

 private:
  PT_HD static std::uint32_t inverted(std::uint32_t medium_id) { return medium_id ^ 0xffffu; }
  PT_HD static std::uint32_t bit_of(const MediumBoundary& boundary) {
    return boundary.inside == no_medium ? 0u : 1u << boundary.inside;
  }
};

/// exp(-extinction * length); `length` may be infinite_distance.
PT_HD Color transmittance(const Color& extinction, float length) {
  return {expf(-(extinction.x * length)), expf(-(extinction.y * length)),
          expf(-(extinction.z * length))};
}

}  // namespace pt
