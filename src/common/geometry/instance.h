// Repetition of geometry.
#pragma once

#include "common/math/transform.h"

namespace pt {

/// A group of meshes placed in the world.
struct Instance {
  std::uint32_t group = 0;  ///< Mesh::group, not 0
  Affine to_world;
};

}  // namespace pt
