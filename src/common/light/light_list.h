// All lights of a scene in one list, and the choice of one of them.
#pragma once

#include "common/light/delta_light.h"
#include "common/light/environment.h"
#include "common/sampling/alias_table.h"

namespace pt {

/// A turned triangle has its last two vertices exchanged: it belongs to an instance that mirrors,
/// and mirroring would turn the side that shines away.
enum class LightKind : std::uint32_t {
  triangle,
  turned_triangle,
  sphere,
  point,
  spot,
  directional
};

/// 64 bytes: four loads.
struct alignas(16) Light {
  Vec3 a;  ///< triangle: a vertex; sphere: centre; point, spot: position
  LightKind kind;
  Vec3 b;  ///< triangle: a vertex; spot, directional: where the light goes
  float weight;
  Vec3 c;                  ///< triangle: a vertex; spot: cosines of both angles, falloff; sphere:
                           ///< square of the radius
  std::uint32_t triangle;  ///< its id, where it has texture coordinates; else no_texture
  Color radiance;          ///< or intensity, or irradiance, as the kind has it
  std::uint32_t emission_texture;

  PT_HD bool is_delta() const { return kind >= LightKind::point; }
  PT_HD DeltaLight delta() const {
    return {static_cast<DeltaLight::Kind>(static_cast<std::uint32_t>(kind) -
                                          static_cast<std::uint32_t>(LightKind::point)),
            a,
            b,
            radiance,
            c.x,
            c.y,
            static_cast<SpotFalloff>(float_to_bits(c.z))};
  }
};

/// A view. One of the lights is chosen with a probability proportional to its weight, about its
/// power; the environment, whose power depends on the size of the scene more than on what it does
/// for it, with a fixed one.
struct LightList {
  const Light* lights = nullptr;
  const AliasEntry* selection = nullptr;  ///< [light]
  std::uint32_t count = 0;
  float total_weight = 0.0f;
  float environment_probability = 0.0f;  ///< 1 without other lights, 0 without an environment

  /// Probability of choosing a light of this weight.
  PT_HD float probability(float weight) const {
    return (1.0f - environment_probability) * weight / total_weight;
  }
};

PT_HD float luminance(const Color& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

/// The weight of a surface of this area (in world space) that emits this radiance.
PT_HD float emitter_weight(const Color& radiance, float area) { return luminance(radiance) * area; }

}  // namespace pt
