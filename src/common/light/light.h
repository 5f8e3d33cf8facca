// Lights but the environment: the description of a light without extent, the record that kernels
// read, and the bounds that the tree of lights needs. lights.h has the types.
#pragma once

#include <cstddef>

#include "common/geometry/bounds.h"
#include "common/light/light_sample.h"
#include "common/texture/texture.h"

namespace pt {

/// Triangles come first. In a flipped one the last two vertices are exchanged: it belongs to an
/// instance that mirrors, and mirroring would flip the side that emits.
enum class LightKind : std::uint8_t {
  triangle,
  flipped_triangle,
  sphere,
  sun,
  point,
  spot,
  projector,
  directional
};

PT_HD bool is_triangle(LightKind kind) { return kind <= LightKind::flipped_triangle; }

/// The falloff of a spot light's intensity between its inner and its outer angle.
enum class SpotFalloff : std::uint32_t {
  smooth,         ///< pbrt's: smoothstep of the cosine
  linear_angle,   ///< Mitsuba's: linear in the angle
  square_cosine,  ///< glTF's KHR_lights_punctual: square of linear in the cosine
};

/// A light without extent, as scenes describe it (pbrt-v4, sections 12.2 and 12.3): no ray can hit
/// it, so only light sampling finds it, with MIS weight 1.
struct DeltaLight {
  LightKind kind = LightKind::point;
  Vec3 position{0.0f};       ///< point, spot: world space
  Vec3 direction{0, 0, -1};  ///< spot, directional: away from the light, unit length
  Color intensity{1.0f};     ///< point, spot: W / sr; directional: W / m^2 across the rays
  float cos_inner = 1.0f;    ///< spot: full intensity within this angle,
  float cos_outer = -1.0f;   ///< none beyond this one,
  SpotFalloff falloff = SpotFalloff::smooth;  ///< in between
  Vec3 right{1, 0, 0};  ///< direction of the picture's u; projector: of length 1 / tan(fov / 2);
                        ///< spot: of unit length
  float aspect = 1.0f;  ///< width over height; negative where the map to the world mirrors
  std::uint32_t texture = no_texture;  ///< the picture; projector: of intensity / cos^3 about the
                                       ///< axis; spot: multiplies the intensity
};

/// The record of a light, 64 bytes: four loads. Each type has a record of its own of this layout,
/// with names for the bytes that are its own: light.as<SpotLight>().
struct alignas(16) Light {
  Vec3 own_a;
  LightKind kind;
  std::uint8_t own_b;
  std::uint16_t own_c;
  Vec3 own_d;
  float weight;  ///< for choosing among lights: W, over pi
  Vec3 own_e;
  std::uint32_t own_f;
  Color radiance;  ///< W / (m^2 sr); delta lights: intensity, W / sr, or irradiance, W / m^2
  std::uint32_t emission_texture;  ///< multiplies the radiance, or no_texture

  template <class Type>
  PT_HD Type as() const {
    static_assert(has_layout<Type>());
    Type own;
    memcpy(reinterpret_cast<char*>(&own), reinterpret_cast<const char*>(this), sizeof own);
    return own;
  }

  template <class Type>
  static PT_HD Light of(const Type& own) {
    static_assert(has_layout<Type>());
    Light light{};
    memcpy(reinterpret_cast<char*>(&light), reinterpret_cast<const char*>(&own), sizeof light);
    return light;
  }

 private:
  template <class Type>
  static constexpr bool has_layout() {
    return sizeof(Type) == sizeof(Light) && offsetof(Type, kind) == offsetof(Light, kind) &&
           offsetof(Type, weight) == offsetof(Light, weight) &&
           offsetof(Type, radiance) == offsetof(Light, radiance) &&
           offsetof(Type, emission_texture) == offsetof(Light, emission_texture);
  }
};
static_assert(sizeof(Light) == 64);

PT_HD float luminance(const Color& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

/// The weight of a surface of this area (in world space) that emits this radiance, times a texture
/// of this mean luminance.
PT_HD float emitter_weight(const Color& radiance, float area, float texture_mean = 1.0f) {
  return luminance(radiance) * area * texture_mean;
}

inline constexpr float half_turn = pi, quarter_turn = 0.5f * pi;

/// The position, directions and intensity of one light or several.
struct LightBounds {
  Bounds box;
  Vec3 axis{0, 0, 1};      ///< of the cone of normals
  float cone = 0.0f;       ///< its half angle, in radians
  float emission = 0.0f;   ///< light goes where the angle to a normal is below this one
  float intensity = 0.0f;  ///< see LightNode
};

}  // namespace pt
