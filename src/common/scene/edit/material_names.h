// What to call a scene's materials.
#pragma once

#include <string>
#include <vector>

#include "common/scene/data/scene_data.h"

namespace pt {

/// By material, no two alike: the name that its file has, "PARENT.0" and "PARENT.1" for what a
/// named material is made of, else "material_N".
std::vector<std::string> material_names(const SceneData& scene);

}  // namespace pt
