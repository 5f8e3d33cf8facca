// Radiance of rays that leave the scene.
#pragma once

#include "common/math/vec.h"

namespace pt {

/// A vertical gradient, the paper's background; equal colours give a constant sky.
struct Sky {
  Color nadir = Color(0.0f);   ///< radiance from straight below, W / (m^2 sr)
  Color zenith = Color(0.0f);  ///< radiance from straight above, W / (m^2 sr)
};

/// `direction` has unit length and points away from the scene.
PT_HD Color sky_radiance(const Sky& sky, const Vec3& direction) {
  const float t = 0.5f * (direction.y + 1.0f);
  return interpolate(sky.nadir, sky.zenith, t);
}

}  // namespace pt
