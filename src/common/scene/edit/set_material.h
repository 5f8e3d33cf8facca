// The parameters of a material as a person thinks of them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/scene/data/material_description.h"

namespace pt {

struct MaterialValue {
  std::string name;
  bool is_color = false;  ///< else a number, in all components
  std::function<Color(const MaterialDescription&)> get;
  std::function<void(MaterialDescription&, const Color&)> set;
};

/// Those of its BSDF, of which a texture, where there is one, is multiplied by the value; and
/// "opacity" where that is one number. What BSDFs precompute from others follows these: a plastic
/// has "eta" in place of it. `material` is no node.
std::vector<MaterialValue> material_values(const MaterialDescription& material);

}  // namespace pt
