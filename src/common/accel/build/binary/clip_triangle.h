// The part of a triangle inside of a box.
#pragma once

#include "common/geometry/triangle.h"

namespace pt {

/// The box of the triangle's part in `box`, widened by hit_margin but not beyond `box`: the margin
/// grows with the whole triangle, however small the part. Empty only where the triangle is further
/// away than that.
Bounds clipped_bounds(const Vec3 (&vertices)[3], const Bounds& box);

}  // namespace pt
