// Which light is asked, and how likely that was.
#pragma once

#include "common/light/light.h"
#include "common/sampling/alias_table.h"

namespace pt {

/// The environment, among the lights of a list.
inline constexpr std::uint32_t environment_light = 0xffffffffu;
inline constexpr std::uint32_t no_light = 0xfffffffeu;

struct LightChoice {
  std::uint32_t light = no_light;
  float pmf = 0.0f;  ///< probability of this choice
};

/// A view. By power, whatever the place: a light with a probability proportional to its weight; the
/// environment, whose power depends on the size of the scene more than on what it does for it, with
/// a fixed one. A selector that depends on the place has the same two functions.
struct LightSelector {
  const Light* lights = nullptr;
  const AliasEntry* table = nullptr;  ///< [light]
  std::uint32_t count = 0;
  float total_weight = 0.0f;
  float environment_probability = 0.0f;  ///< 1 without other lights, 0 without an environment

  /// For light that arrives at `point`; u uniform in [0, 1)^2. The one number that decides about
  /// the environment is used again for the light, together with the other: 47 bits are left.
  PT_HD LightChoice sample(const Vec3& point, float u0, float u1) const {
    const float p = environment_probability;
    if (u0 < p) return {environment_light, p};
    if (count == 0) return {};
    const std::uint32_t light = sample_alias(table, count, (u0 - p) / (1.0f - p), u1).index;
    return {light, pmf(point, light)};
  }

  /// The probability with which sample(point) names `light`.
  PT_HD float pmf(const Vec3& /*point*/, std::uint32_t light) const {
    if (light == environment_light) return environment_probability;
    return (1.0f - environment_probability) * lights[light].weight / total_weight;
  }
};

/// A view: which light a surface that shines is. That of a triangle is the first one of its
/// instance (InstanceRecord::number; 0 in a scene without instances) plus its rank in the
/// instance's group.
struct LightMap {
  const std::uint32_t* first = nullptr;    ///< [instance]
  const std::uint32_t* rank = nullptr;     ///< [triangle id]
  const std::uint32_t* spheres = nullptr;  ///< [sphere]

  PT_HD std::uint32_t of_triangle(std::uint32_t id, std::uint32_t instance) const {
    return first[instance] + rank[id];
  }
};

}  // namespace pt
