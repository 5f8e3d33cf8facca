// The record of any light but the environment.
#pragma once

#include "common/light/delta_light.h"

namespace pt {

/// A LightError in three bytes, rounded up: the relative part to a power of two, by its exponent;
/// the absolute one to the upper half of a float.
struct PackedLightError {
  std::uint8_t relative = 0;
  std::uint16_t absolute = 0;

  PT_HD LightError unpack() const {
    return {bits_to_float(std::uint32_t{absolute} << 16),
            bits_to_float(std::uint32_t{relative} << 23)};
  }
};

/// `error` is neither negative nor NaN.
inline PackedLightError pack_light_error(const LightError& error) {
  const auto round_up = [](float x, int bits) {
    const std::uint32_t unit = 1u << bits, largest = float_to_bits(3e38f) >> bits;
    const std::uint32_t up = (float_to_bits(x) + (unit - 1)) >> bits;
    return up < largest ? up : largest;
  };
  return {static_cast<std::uint8_t>(round_up(error.relative, 23)),
          static_cast<std::uint16_t>(round_up(error.absolute, 16))};
}

/// 64 bytes: four loads. Edges, not vertices: far from the origin they are more precise.
struct alignas(16) Light {
  Vec3 a;  ///< triangle: a vertex; sphere: centre; point, spot: position
  LightKind kind;
  std::uint8_t relative_error;   ///< triangle: see PackedLightError
  std::uint16_t absolute_error;  ///< triangle
  Vec3 b;  ///< triangle: the edge to the second vertex; spot, directional: where the light goes;
           ///< sun: where it is
  float weight;
  Vec3 c;  ///< triangle: the edge to the third vertex; spot: cosines of both angles,
           ///< falloff; projector: see DeltaLight::right; sphere: square of the radius; sun: see
           ///< Sun::one_minus_cos
  std::uint32_t triangle;  ///< its id, where it has texture coordinates, else no_texture;
                           ///< projector: the bits of its aspect; spot with a picture: pack_roll()
  Color radiance;  ///< W / (m^2 sr); delta lights: intensity, W / sr, or irradiance, W / m^2
  std::uint32_t emission_texture;

  PT_HD LightError error() const {
    return PackedLightError{relative_error, absolute_error}.unpack();
  }
  PT_HD DeltaLight delta() const {
    return {kind, a, b, radiance, c.x, c.y, static_cast<SpotFalloff>(float_to_bits(c.z))};
  }
};

static_assert(sizeof(Light) == 64);

PT_HD float luminance(const Color& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

/// The weight of a surface of this area (in world space) that emits this radiance, times a texture
/// of this mean luminance.
PT_HD float emitter_weight(const Color& radiance, float area, float texture_mean = 1.0f) {
  return luminance(radiance) * area * texture_mean;
}

}  // namespace pt
