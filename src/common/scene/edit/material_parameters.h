// The parameters of materials by name, as users see them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/scene/data/scene_data.h"

namespace pt {

/// The BSDF's fields, by their indices.
std::vector<BsdfParameter> bsdf_parameters(MaterialKind kind);

struct MaterialValue {
  std::string name;
  bool is_color = false;  ///< else a number, in all components
  std::function<Color(const MaterialDescription&)> get;
  std::function<void(MaterialDescription&, const Color&)> set;
};

/// The parameters of its BSDF, whose textures multiply the values; and "opacity" where that is one
/// number. Setting one updates the precomputed parameters; a plastic has "eta" in their place.
/// `material` is not a node.
std::vector<MaterialValue> material_values(const MaterialDescription& material);

/// A unique name for each material: that in its file; "PARENT.0" and "PARENT.1" for the children of
/// a named material; else "material_N".
std::vector<std::string> material_names(const SceneData& scene);

}  // namespace pt
