// What a material of a scene is made of.
#pragma once

#include <algorithm>
#include <unordered_set>
#include <vector>

#include "common/scene/data/scene_data.h"

namespace pt {

/// The material and all that it is made of, each once, although blends of blends may name one of
/// them 2^n times. The pointers are good until the scene gets another material.
inline std::vector<const MaterialDescription*> parts_of(const SceneData& scene,
                                                        std::uint32_t material) {
  std::vector<const MaterialDescription*> parts{&scene.materials[material]};
  std::unordered_set<std::uint32_t> known{material};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i]->node == MaterialNode::none) continue;
    for (const std::uint32_t child : parts[i]->children) {
      if (known.insert(child).second) parts.push_back(&scene.materials[child]);
    }
  }
  return parts;
}

/// Whether `test` is true of one of them.
template <class Test>
bool any_part(const SceneData& scene, std::uint32_t material, Test&& test) {
  const std::vector<const MaterialDescription*> parts = parts_of(scene, material);
  return std::any_of(parts.begin(), parts.end(), [&](const auto* part) { return test(*part); });
}

}  // namespace pt
