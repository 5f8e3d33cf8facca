// The record of any light but the environment.
#pragma once

#include <cmath>

#include "common/light/delta_light.h"
#include "common/math/frame.h"
#include "common/math/sincos.h"

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

  PT_HD bool is_delta() const { return pt::is_delta(kind); }
  PT_HD LightError error() const {
    return PackedLightError{relative_error, absolute_error}.unpack();
  }
  PT_HD DeltaLight delta() const {
    return {kind, a, b, radiance, c.x, c.y, static_cast<SpotFalloff>(float_to_bits(c.z))};
  }
};

static_assert(sizeof(Light) == 64);

/// What a projector sends in a direction: its picture at `uv`, times `factor`.
struct Projection {
  Vec2 uv;
  float factor = 0.0f;
};

PT_HD Projection project(const Light& light, const Vec3& direction) {
  const float cosine = dot(light.b, direction);
  const Vec3 up = bits_to_float(light.triangle) * cross_rounded(light.c, light.b);
  const float u = 0.5f + 0.5f * dot(light.c, direction) / cosine;
  const float v = 0.5f + 0.5f * dot(up, direction) / cosine;
  const bool inside = cosine > 0.0f && u >= 0.0f && u <= 1.0f && v >= 0.0f && v <= 1.0f;
  return {{u, v}, inside ? 1.0f / (cosine * cosine * cosine) : 0.0f};
}

/// The rotation of a spot's picture about the axis: the angle of `right` in the axis' frame, in
/// turns from 0 to 1, less 1 where the picture is mirrored.
inline std::uint32_t pack_roll(const DeltaLight& spot) {
  const Frame frame = make_frame(spot.direction);
  const float angle =
      std::atan2(glm::dot(spot.right, frame.bitangent), glm::dot(spot.right, frame.tangent));
  const float turns = angle / (2.0f * pi);
  const float positive = turns < 0.0f ? turns + 1.0f : turns;
  return float_to_bits(spot.aspect < 0.0f ? positive - 1.0f : positive);
}

/// Where a spot's picture is looked up for a direction: it fills the cone of the outer angle.
PT_HD Vec2 spot_uv(const Light& light, const Vec3& direction) {
  const float turns = bits_to_float(light.triangle);
  const Frame frame = make_frame(light.b);
  const SinCos roll = sincos_2pi(turns);
  const Vec3 right = roll.cos * frame.tangent + roll.sin * frame.bitangent;
  const Vec3 up = (turns < 0.0f ? -1.0f : 1.0f) * cross_rounded(right, light.b);
  const float cos_outer = light.c.x < light.c.y ? light.c.x : light.c.y;
  const float tangent = sqrtf(fmaxf(1.0f - cos_outer * cos_outer, 0.0f)) / cos_outer;
  const float scale = 0.5f / (dot(light.b, direction) * tangent);
  return {0.5f + scale * dot(right, direction), 0.5f + scale * dot(up, direction)};
}

PT_HD float luminance(const Color& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

/// The weight of a surface of this area (in world space) that emits this radiance, times a texture
/// of this mean luminance.
PT_HD float emitter_weight(const Color& radiance, float area, float texture_mean = 1.0f) {
  return luminance(radiance) * area * texture_mean;
}

}  // namespace pt
