// What `ptexp trace` and `ptexp rays` work on.
#pragma once

#include <string>

#include "common/scene/data/scene_data.h"

namespace pt {

/// A .mesh file (TRBMESH1), or any scene as --scene takes it; its quads become triangles.
SceneData load_traced_scene(const std::string& name);

/// The same without its spheres. Throws Error where there are no triangles.
SceneData load_triangles(const std::string& name);

}  // namespace pt
