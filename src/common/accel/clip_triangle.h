// The part of a triangle inside of a box.
#pragma once

#include "common/geometry/bounds.h"

namespace pt {

/// How far from its part of a triangle a ray may be when the intersection test says that it meets
/// this part: the test's rounding grows with the distance of the triangle's own vertices, however
/// small the part. Clipped boxes that are not larger by this lose hits.
float clip_tolerance(const Vec3 (&vertices)[3]);

/// The box of the triangle's part in `box`, widened by the tolerance but not beyond `box`. Empty
/// only where the triangle is further away than that.
Bounds clipped_bounds(const Vec3 (&vertices)[3], const Bounds& box);

}  // namespace pt
