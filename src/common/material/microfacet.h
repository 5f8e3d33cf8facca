// Rough surfaces as microfacets: the distributions of Trowbridge and Reitz (GGX) and of Beckmann,
// stretched along the axes; Smith's shadowing; sampling of the normals that a direction sees
// (Heitz 2014, 'Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs').
#pragma once

#include "common/math/functions.h"
#include "common/math/vec.h"
#include "common/sampling/warp.h"

namespace pt {

struct Microfacets {
  float alpha_x, alpha_y;  ///< roughness along x and y, above 0
  bool is_beckmann;        ///< else GGX

  /// Below this, floats cannot tell normals apart.
  static constexpr float alpha_min = 1e-4f;

  PT_HD static Microfacets make(float alpha_x, float alpha_y, bool is_beckmann = false) {
    return {fmaxf(alpha_x, alpha_min), fmaxf(alpha_y, alpha_min), is_beckmann};
  }

  /// Density of the facets' area by their unit normal m, m.z >= 0.
  PT_HD float distribution(const Vec3& m) const {
    const float x = divide(m.x, alpha_x), y = divide(m.y, alpha_y);
    const float scale = divide(inverse_pi, alpha_x * alpha_y);
    const float slopes = fused_multiply_add(x, x, y * y);
    const float cos2 = m.z * m.z;
    if (is_beckmann) return scale * beckmann_distribution(slopes, cos2);
    const float sum = fused_multiply_add(m.z, m.z, slopes);
    return scale * divide(1.0f, sum * sum);
  }

  /// The part of the facets that `w` sees (Smith's G1), divided by |w.z|: finite at the horizon,
  /// unless it is perfectly smooth.
  PT_HD float visible_over_cosine(const Vec3& w) const {
    const float x = alpha_x * w.x, y = alpha_y * w.y, z = fabsf(w.z);
    const float slopes = fused_multiply_add(x, x, y * y);
    if (is_beckmann) return beckmann_visible(z, slopes);
    return divide(2.0f, z + fmaxf(square_root(fused_multiply_add(z, z, slopes)), 1e-20f));
  }

  /// A normal that w sees, w.z >= 0: density distribution(m) visible_over_cosine(w) dot(w, m) per
  /// solid angle.
  PT_HD Vec3 sample_visible(const Vec3& w, float u0, float u1) const {
    const Vec3 stretched = normalize(Vec3(alpha_x * w.x, alpha_y * w.y, w.z));
    const Vec3 h = is_beckmann ? sample_beckmann(stretched, u0, u1) : sample_cap(stretched, u0, u1);
    return normalize(Vec3(alpha_x * h.x, alpha_y * h.y, h.z));
  }

 private:
  static constexpr float inverse_sqrt_pi = 0.5641895835f;

  // Beckmann's functions are long. Not inlined, they lie in a kernel once, and not between the code
  // of the more frequent GGX.

  PT_NOINLINE static float beckmann_distribution(float slopes, float cos2) {
    if (slopes > 80.0f * cos2) return 0.0f;  // e^-80, and no division by 0
    return expf(-slopes / cos2) / (cos2 * cos2);
  }

  PT_NOINLINE static float beckmann_visible(float z, float slopes) {
    const float root = sqrtf(slopes), a = z / fmaxf(root, 1e-20f);
    const float tail = inverse_sqrt_pi * root * expf(-a * a);
    return 2.0f / fused_multiply_add(z, 1.0f + erff(a), fmaxf(tail, 1e-20f));
  }

  /// On roughness 1: the sphere's cap that mirrors w into the upper hemisphere (Dupuy and Benyoub
  /// 2023, 'Sampling Visible GGX Normals with Spherical Caps').
  PT_HD static Vec3 sample_cap(const Vec3& w, float u0, float u1) {
    const SinCos phi = sincos_2pi(u0);
    const float height = (1.0f - u1) * (1.0f + w.z);
    const float z = height - w.z;
    const float sine = fast_sqrt(fmaxf(0.0f, fused_multiply_add(-z, z, 1.0f)));
    return {fused_multiply_add(sine, phi.cos, w.x), fused_multiply_add(sine, phi.sin, w.y), height};
  }

  /// On roughness 1: slopes of a Gaussian, weighted by what w sees of them. The one across w is
  /// independent; the one along w has the distribution below, which Newton's method inverts in
  /// x = erf(slope) (Jakob 2014, 'An Improved Visible Normal Sampling Routine for the Beckmann
  /// Distribution').
  PT_NOINLINE static Vec3 sample_beckmann(Vec3 w, float u0, float u1) {
    const float sine2 = fused_multiply_add(w.x, w.x, w.y * w.y);
    const float sine = sqrtf(sine2);
    const float along = visible_slope(sine, fmaxf(w.z, 1e-6f), u0);
    const float across = erf_inverse(fused_multiply_add(2.0f, u1, -1.0f));
    const float c = sine > 0.0f ? w.x / sine : 1.0f, s = sine > 0.0f ? w.y / sine : 0.0f;
    return {-difference_of_products(c, along, s, across), -fused_multiply_add(s, along, c * across),
            1.0f};
  }

  PT_HD static float visible_slope(float sine, float cosine, float u) {
    const float tangent = sine / cosine, tail = inverse_sqrt_pi * tangent;
    const float cotangent = cosine / fmaxf(sine, 1e-10f);
    const float last = erff(cotangent);
    // The distribution's value at x, times `total`: 1 + x + tail exp(-slope^2).
    const float total = fused_multiply_add(tail, expf(-cotangent * cotangent), 1.0f + last);
    const float wanted = u * total;
    // Exact for light along the horizon, where the function is bent most.
    float x = fused_multiply_add(-(1.0f + last), erff(sqrtf(-logf(fmaxf(u, 1e-7f)))), last);
    float slope = erf_inverse(x);
    PT_UNROLL(1)
    for (int i = 0; i < newton_steps; ++i) {
      const float value = fused_multiply_add(tail, expf(-slope * slope), 1.0f + x) - wanted;
      x = x - value / fused_multiply_add(-slope, tangent, 1.0f);
      x = fminf(fmaxf(x, -1.0f), last);
      slope = erf_inverse(x);
    }
    return slope;
  }

  static constexpr int newton_steps = 3;  ///< to 1e-6 of the distribution
};

/// `wo` mirrored by the normal m; `cosine` is their dot product.
PT_HD Vec3 mirrored_by(const Vec3& wo, const Vec3& m, float cosine) {
  return add_scaled(-wo, 2.0f * cosine, m);
}

/// `wo` refracted at the normal m; `cosine`, above 0, is their dot product, `eta` the index beyond
/// over before. Where all is reflected: along the surface.
PT_HD Vec3 refracted(const Vec3& wo, const Vec3& m, float cosine, float eta) {
  const float inverse = divide(1.0f, eta);
  const float sin2 = fmaxf(0.0f, fused_multiply_add(-cosine, cosine, 1.0f)) * inverse * inverse;
  const float along = square_root(fmaxf(0.0f, 1.0f - sin2));
  return add_scaled(-inverse * wo, fused_multiply_add(inverse, cosine, -along), m);
}

}  // namespace pt
