// What kernels are specialized for: each combination is a kernel of its own.
#pragma once

#include "common/choices/accel.h"

namespace pt {

/// What rays can hit. `mixed`: triangles, instances of triangles, spheres.
enum class Geometry { spheres_and_quads, triangles, mixed };

/// The light sources. `sky`: the environment alone; `emitters`: spheres and quads as well; `full`:
/// lights of all types and an environment, with textures on all surfaces.
enum class Lighting { sky, emitters, full };

struct SceneTraits {
  Accel accel = Accel::brute;
  Geometry geometry = Geometry::spheres_and_quads;
  Lighting lighting = Lighting::sky;
  bool has_masks = false;
  bool has_media = false;

  constexpr bool operator==(const SceneTraits&) const = default;
  constexpr bool has_lights() const { return lighting != Lighting::sky; }
};

}  // namespace pt
