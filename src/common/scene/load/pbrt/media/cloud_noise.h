// The density of a cloud, as that of pbrt.
#pragma once

#include "common/math/vec.h"

namespace pt::pbrt {

/// Gradient noise with cells of size 1: Perlin 2002, 'Improving Noise', with the directions in
/// which pbrt's slopes go. Zero at integers.
float perlin_noise(const Vec3& p);

struct CloudShape {
  float density = 1.0f, wispiness = 1.0f, frequency = 5.0f;
};

/// In [0, 1]: more the lower, and nothing but noise above y = 1/2.
float cloud_density(const CloudShape& shape, const Vec3& p);

}  // namespace pt::pbrt
