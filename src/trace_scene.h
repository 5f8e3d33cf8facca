// The triangles that `ptexp trace` and `ptexp rays` work on.
#pragma once

#include <string>

#include "common/scene/scene_data.h"

namespace pt {

/// A .mesh file (TRBMESH1), or any scene as --scene takes it: its quads become triangles, its
/// spheres are left out. Throws Error where there are no triangles.
SceneData load_triangles(const std::string& name);

}  // namespace pt
