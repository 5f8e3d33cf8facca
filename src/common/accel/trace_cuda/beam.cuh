// What bounds a warp's coherent rays: intervals of origins and of inverse directions.
#pragma once

#include "common/accel/traverse_cwbvh.h"

namespace pt {

/// Axis by axis, in shared memory. Distances are relative to `center`, the first ray's origin.
/// Along an axis the beam enters a plane at distance d not before d * near_inverse + near_offset,
/// and leaves it not after d * far_inverse + far_offset; behind the origins both are negative.
struct alignas(16) Beam {
  float center[4];
  float outward[4];  ///< beam_tolerance, or less that for positive directions
  float near_inverse[4], near_offset[4];
  float far_inverse[4], far_offset[4];
};

/// As cwbvh_origin_tolerance, of a beam's rays, relative to the distance from its center.
inline constexpr float beam_tolerance = 16.0f * half_ulp;

/// Beams wider than this, relative to their direction, do not pay.
inline constexpr float beam_width_max = 0.25f;

/// The least and the largest |x| of a warp, for the same signs of all.
__device__ inline float warp_min_magnitude(float x) {
  return __uint_as_float(warp_min(__float_as_uint(x) & 0x7fffffffu));
}
__device__ inline float warp_max_magnitude(float x) {
  return __uint_as_float(warp_max(__float_as_uint(x) & 0x7fffffffu));
}

/// By the whole warp. Sets `width` to how much the directions differ; false: in their signs.
__device__ inline bool make_beam_axis(float origin, float inverse, int i, Beam& beam,
                                      float& width) {
  constexpr unsigned whole_warp = 0xffffffffu;
  const unsigned negative = __ballot_sync(whole_warp, inverse < 0.0f);
  const float center = __shfl_sync(whole_warp, origin, 0);
  const float spread = __all_sync(whole_warp, origin == center)
                           ? 0.0f
                           : warp_max_magnitude(origin - center) * (1.0f + beam_tolerance);
  const float least = warp_min_magnitude(inverse), most = warp_max_magnitude(inverse);
  beam.center[i] = center;
  beam.outward[i] = negative != 0 ? beam_tolerance : -beam_tolerance;
  beam.near_inverse[i] = negative != 0 ? -least : least;
  beam.far_inverse[i] = negative != 0 ? -most : most;
  beam.near_offset[i] = -spread * least;
  beam.far_offset[i] = spread * most;
  width = (most - least) / least;
  return negative == 0 || negative == whole_warp;
}

/// By the whole warp, whose lanes read the beam after the next __syncwarp. False in lanes that see
/// rays that are not coherent; the inverse directions are finite.
__device__ inline bool make_beam(const Vec3& origin, const Vec3& inverse, Beam& beam) {
  float width_x, width_y, width_z;
  bool is_coherent = make_beam_axis(origin.x, inverse.x, 0, beam, width_x);
  is_coherent &= make_beam_axis(origin.y, inverse.y, 1, beam, width_y);
  is_coherent &= make_beam_axis(origin.z, inverse.z, 2, beam, width_z);
  return is_coherent && fminf(width_x, fminf(width_y, width_z)) < beam_width_max;
}

/// Where the beam may be inside of a box, before t_max; widened.
__device__ inline bool beam_meets(const Beam& beam, const Vec3& near_planes, const Vec3& far_planes,
                                  float t_max) {
  float near = 0.0f, far = t_max;
  PT_UNROLL(3)
  for (int i = 0; i < 3; ++i) {
    near = fmaxf(near, __fmaf_rn(near_planes[i], beam.near_inverse[i], beam.near_offset[i]));
    far = fminf(far, __fmaf_rn(far_planes[i], beam.far_inverse[i], beam.far_offset[i]));
  }
  return near <= far * (1.0f + slab_tolerance);
}

}  // namespace pt
