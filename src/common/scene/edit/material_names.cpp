#include "common/scene/edit/material_names.h"

#include <fmt/format.h>

#include <set>

namespace pt {

std::vector<std::string> material_names(const SceneData& scene) {
  std::vector<std::string> names(scene.materials.size());
  for (const auto& [material, name] : scene.names.materials) names[material] = name;
  for (std::size_t m = names.size(); m-- > 0;) {  // made of earlier materials
    const MaterialDescription& material = scene.materials[m];
    if (names[m].empty() || material.node == MaterialNode::none) continue;
    const bool has_two = material.children[0] != material.children[1];
    for (int i = 0; i <= static_cast<int>(has_two); ++i) {
      std::string& child = names[material.children[i]];
      if (child.empty()) child = has_two ? fmt::format("{}.{}", names[m], i) : names[m];
    }
  }
  std::set<std::string> taken;
  for (std::size_t m = 0; m < names.size(); ++m) {
    if (names[m].empty()) names[m] = fmt::format("material_{}", m);
    std::string name = names[m];
    const bool is_node = scene.materials[m].node != MaterialNode::none;  // has no parameters
    for (int n = 2; !is_node && !taken.insert(name).second; ++n)
      name = fmt::format("{}_{}", names[m], n);
    names[m] = name;
  }
  return names;
}

}  // namespace pt
