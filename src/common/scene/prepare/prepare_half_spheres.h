// Spheres for a scan in half precision (accel/scan_halves.h) that loses no hit.
//
// The scan computes, of a sphere around c of radius R and a ray's axes A and B (unit vectors) and
// places a and b in float, x = c.A - a, y = c.B - b and R^2 - x^2 - y^2, whose sign says whether
// the ray may hit it. Be u = 2^-11, the largest relative error of rounding to a half.
//
// If the line intersects the sphere, |x| <= R and |y| <= R. Then the computed x differs from the
// exact one by at most
//   |c - rounded c|      the centre's own rounding, which is known,
//   u |c|                the axis',
//   u (|c| + R)          the place's, which is at most |c.A| + |x|,
//   u (|cx, cy| + R), u (|cx| + R), u R     the sums' of three products, each of which is the final
//                        x less the products that are not in it yet,
// in all, with 1 % for products of errors and 2^-19 for numbers below the least normal half,
//   e = |c - rounded c| + 1.01 u (2 |c| + |cx, cy| + |cx| + 4 R) + 2^-19.
// So x^2 + y^2 <= (R + sqrt(2) e)^2 =: Q for the computed ones. The difference S - x^2 is rounded
// to at least (S - x^2)(1 - u) - 2^-25, and what then stays non-negative when y^2 is subtracted is
// rounded to a number without a sign. S = (Q + 2^-24) / (1 - u) suffices, rounded upwards.
//
// Nothing is asked of rays. A place beyond the halves is infinite, and so are x^2 and the
// difference, which is negative, as it should be. A ray that is NaN hits nothing.
//
// Spheres that are much larger than the others would leave these too little of the halves' range.
// They are candidates always: a line that passes through the scene intersects its ground anyway.
#pragma once

#include <span>
#include <vector>

#include "common/geometry/primitives.h"
#include "common/geometry/sphere.h"

namespace pt {

struct HalfScan {
  std::vector<HalfSpheres> groups;
  float scale = 1.0f;  ///< a power of two: the spheres are multiplied by it
};

/// `spheres`: what a scan in float takes.
HalfScan prepare_half_spheres(std::span<const Sphere> spheres);

}  // namespace pt
