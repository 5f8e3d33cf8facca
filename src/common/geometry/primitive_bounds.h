// Boxes around spheres and quads.
#pragma once

#include "common/geometry/bounds.h"
#include "common/geometry/quad.h"
#include "common/geometry/sphere.h"

namespace pt {

PT_HD Bounds sphere_bounds(const Sphere& sphere) {
  return {sphere.center - sphere.radius(), sphere.center + sphere.radius()};
}

PT_HD Bounds quad_bounds(const Quad& quad) {
  Bounds bounds;
  for (int i = 0; i < 4; ++i) {
    bounds.grow(quad.corner + static_cast<float>(i & 1) * quad.edge_a +
                static_cast<float>(i >> 1) * quad.edge_b);
  }
  return bounds;
}

}  // namespace pt
