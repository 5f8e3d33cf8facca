// Light selection: which light is sampled, and its probability (pbrt-v4, section 12.6).
#pragma once

#include "common/light/light.h"
#include "common/light/light_tree.h"
#include "common/sampling/alias_table.h"

namespace pt {

/// The environment, among the lights of a list.
inline constexpr std::uint32_t environment_light = 0xffffffffu;
inline constexpr std::uint32_t no_light = 0xfffffffeu;

struct LightChoice {
  std::uint32_t light = no_light;
  float pmf = 0.0f;  ///< probability of this choice
};

/// A view. Without a tree the shading point does not matter: a light is chosen with a probability
/// proportional to its weight. With a tree, lights that have a position are chosen by their
/// estimated contribution at the shading point; `table` has the others, which together get a fixed
/// probability. The environment always gets one, since its power depends mostly on the size of the
/// scene.
struct LightSelector {
  const Light* lights = nullptr;
  const AliasEntry* table = nullptr;  ///< [light - table_first]
  std::uint32_t table_first = 0;      ///< with a tree: lights from here on have no position
  LightTree tree;
  std::uint32_t count = 0;  ///< of the table
  float total_weight = 0.0f;
  float environment_probability = 0.0f;  ///< 1 without other lights, 0 without an environment
  float table_probability = 1.0f;        ///< if not the environment: below 1 with a tree

  PT_HD bool has_tree() const { return table_probability < 1.0f; }

  /// For light that arrives at `point`; u uniform in [0, 1)^2. The component that
  /// chooses between environment and lights is used again, with the other, to choose the light: 47
  /// bits are left.
  PT_HD LightChoice sample(const Vec3& point, Receiver receiver, float u0, float u1) const {
    if (has_tree()) return sample_with_tree(point, receiver, u0, u1);
    const float p = environment_probability;
    if (u0 < p) return {environment_light, p};
    if (count == 0) return {};
    const std::uint32_t light = sample_alias(table, count, divide(u0 - p, 1.0f - p), u1).index;
    return {light, listed_pmf(light)};
  }

  /// The probability with which sample(point, receiver) names `light`.
  PT_HD float pmf(const Vec3& point, Receiver receiver, std::uint32_t light) const {
    if (light == environment_light) return environment_probability;
    if (!has_tree()) return listed_pmf(light);
    const std::uint32_t trail = tree.trail[light];
    if (trail == LightTree::outside) return distant_pmf(light);
    return tree_probability() * light_tree_pmf(tree, LightReceiver(point, receiver), trail);
  }

  /// As pmf(), for a light without position, at any shading point.
  PT_HD float distant_pmf(std::uint32_t light) const {
    return table_probability * listed_pmf(light);
  }

 private:
  PT_HD float tree_probability() const {
    return (1.0f - environment_probability) * (1.0f - table_probability);
  }

  PT_HD float listed_pmf(std::uint32_t light) const {
    return divide((1.0f - environment_probability) * lights[light].weight, total_weight);
  }

  PT_HD LightChoice sample_with_tree(const Vec3& point, Receiver receiver, float u0,
                                     float u1) const {
    Interval random(u0, u1);
    if (random.choose(environment_probability)) return {environment_light, environment_probability};
    if (random.choose(table_probability)) {
      const std::uint32_t light = table_first + sample_alias(table, count, random.unit()).index;
      return {light, distant_pmf(light)};
    }
    float pmf = 1.0f;
    const std::uint32_t light =
        sample_light_tree(tree, LightReceiver(point, receiver), random, pmf);
    return {light, tree_probability() * pmf};
  }
};

/// A view: the index of the light that an emissive primitive is. That of a triangle is the first
/// one of its instance (InstanceRecord::index; 0 in a scene without instances) plus its rank in the
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
