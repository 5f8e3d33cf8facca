// The triangle test behind the projection, of as many rays or triangles as there are lanes. Each
// lane does the very operations of intersect_triangle (geometry/triangle.h), in their order and
// without contraction, so the hits are the same, bit for bit.
#pragma once

#include "common/accel/trace_cpu/lanes.h"

#ifdef __x86_64__

namespace pt {

/// Which lanes meet their triangle at t, t_min < t <= t_max, and that t. `x`, `y` and `depth` are
/// its projected vertices, `inverse` is TriangleRay's.
template <class L>
PT_LANES inline typename L::Mask meet_projected(const typename L::Float (&x)[3],
                                                const typename L::Float (&y)[3],
                                                const typename L::Float (&depth)[3],
                                                typename L::Float inverse, typename L::Float t_min,
                                                typename L::Float t_max, typename L::Float& t) {
  using Float = typename L::Float;
  // Rounded differences of exact products.
  const Float u = L::difference_of_products(x[2], y[1], y[2], x[1]);
  const Float v = L::difference_of_products(x[0], y[2], y[0], x[2]);
  const Float w = L::difference_of_products(x[1], y[0], y[1], x[0]);
  const Float zero = L::all(0.0f);
  const Float least = L::least(u, L::least(v, w)), most = L::most(u, L::most(v, w));
  const typename L::Mask missed = L::both(L::less(least, zero), L::less(zero, most));
  t = zero;
  if (L::bits(missed) == L::every_bit) return L::but_not(missed, missed);
  const Float sum = L::sum_of_products(u, depth[0], v, depth[1], w, depth[2]);
  t = sum * (L::all(1.0f) / (u + v + w)) * inverse;
  return L::but_not(L::both(L::less(t_min, t), L::less_equal(t, t_max)), missed);
}

}  // namespace pt

#endif
