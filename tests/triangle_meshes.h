// Meshes that are hard on an acceleration structure, each kind in its own way.
#pragma once

#include "common/geometry/mesh.h"
#include "statistics.h"

namespace pt {

inline Vec3 point_in_cube(TestRandom& random, double half_size) {
  const auto coordinate = [&] { return static_cast<float>(random.uniform(-half_size, half_size)); };
  const float x = coordinate(), y = coordinate();
  return {x, y, coordinate()};
}

}  // namespace pt
