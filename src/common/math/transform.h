// Affine maps of space, and orthonormal frames.
#pragma once

#include "common/math/vec.h"

namespace pt {

/// x -> linear part x + translation, as three rows (a, b, c, translation): 48 bytes.
struct alignas(16) Affine {
  Vec4 row[3] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};

  // Fused alike in every kernel.
  PT_HD Vec3 point(const Vec3& p) const {
    const auto sum = [&p](const Vec4& r) {
      return fused_multiply_add(r.x, p.x,
                                fused_multiply_add(r.y, p.y, fused_multiply_add(r.z, p.z, r.w)));
    };
    return {sum(row[0]), sum(row[1]), sum(row[2])};
  }
  PT_HD Vec3 vector(const Vec3& v) const {
    return {dot(Vec3(row[0]), v), dot(Vec3(row[1]), v), dot(Vec3(row[2]), v)};
  }
  /// The transpose applied to a vector: with the inverse map, this transforms normals (their
  /// length changes).
  PT_HD Vec3 transposed(const Vec3& v) const {
    return weighted_sum(v, Vec3(row[0]), Vec3(row[1]), Vec3(row[2]));
  }
  /// A bound of the terms of point(p) for all |p| <= size, componentwise: the scale of its rounding
  /// error.
  PT_HD Vec3 absolute(const Vec3& size) const {
    const auto sum = [&](const Vec4& r) {
      return fabsf(r.x) * size.x + fabsf(r.y) * size.y + fabsf(r.z) * size.z + fabsf(r.w);
    };
    return {sum(row[0]), sum(row[1]), sum(row[2])};
  }
  PT_HD Vec3 translation() const { return {row[0].w, row[1].w, row[2].w}; }
  PT_HD float determinant() const {
    return row[0].x * (row[1].y * row[2].z - row[1].z * row[2].y) -
           row[0].y * (row[1].x * row[2].z - row[1].z * row[2].x) +
           row[0].z * (row[1].x * row[2].y - row[1].y * row[2].x);
  }
};

inline bool operator==(const Affine& a, const Affine& b) {
  return a.row[0] == b.row[0] && a.row[1] == b.row[1] && a.row[2] == b.row[2];
}

/// first b, then a.
PT_HD Affine operator*(const Affine& a, const Affine& b) {
  Affine c;
  for (int i = 0; i < 3; ++i) {
    c.row[i] = a.row[i].x * b.row[0] + a.row[i].y * b.row[1] + a.row[i].z * b.row[2];
    c.row[i].w += a.row[i].w;
  }
  return c;
}

/// The inverse, computed in double precision; `a` must not be singular. Has the same bits on every
/// device: doubles hold the products of a cofactor exactly, so that fusing them changes nothing.
PT_HD Affine inverse(const Affine& a) {
  const auto at = [&](int i, int j) { return static_cast<double>(a.row[i % 3][j % 3]); };
  const auto cofactor = [&](int i, int j) {
    return at(i + 1, j + 1) * at(i + 2, j + 2) - at(i + 1, j + 2) * at(i + 2, j + 1);
  };
  const auto term = [&](int j) { return at(0, j) * cofactor(0, j); };
  const double determinant = term(0) + term(1) + term(2);
  Affine result;
  for (int i = 0; i < 3; ++i) {
    double moved = 0;
    for (int j = 0; j < 3; ++j) {
      const double value = cofactor(j, i) / determinant;
      result.row[i][j] = static_cast<float>(value);
      moved -= value * static_cast<double>(a.row[j].w);
    }
    result.row[i].w = static_cast<float>(moved);
  }
  return result;
}

/// Whether inverse(a) takes everything back, and a unit vector has a length in single precision
/// after either of them; whether `a` mirrors is the sign of its determinant, which must have one.
inline bool is_invertible(const Affine& a) {
  const auto is_small = [](const Affine& map) {
    float sum = 0;
    for (const Vec4& row : map.row)
      for (int i = 0; i < 4; ++i) sum += std::fabs(row[i]);
    return sum < 1e18f;  // has a square
  };
  const float determinant = a.determinant();
  return std::isfinite(determinant) && determinant != 0.0f && is_small(a) && is_small(inverse(a));
}

inline Affine translate(const Vec3& by) {
  return {{{1, 0, 0, by.x}, {0, 1, 0, by.y}, {0, 0, 1, by.z}}};
}
inline Affine scale(const Vec3& by) {
  return {{{by.x, 0, 0, 0}, {0, by.y, 0, 0}, {0, 0, by.z, 0}}};
}

/// About `axis`, counterclockwise when it points to the viewer (Rodrigues' formula).
inline Affine rotate(const Vec3& axis, float degrees) {
  const Vec3 k = axis / glm::length(axis);
  const float angle = degrees * pi / 180.0f;
  const float c = std::cos(angle), s = std::sin(angle), d = 1.0f - c;
  return {{{c + k.x * k.x * d, k.x * k.y * d - k.z * s, k.x * k.z * d + k.y * s, 0},
           {k.y * k.x * d + k.z * s, c + k.y * k.y * d, k.y * k.z * d - k.x * s, 0},
           {k.z * k.x * d - k.y * s, k.z * k.y * d + k.x * s, c + k.z * k.z * d, 0}}};
}

// Frames around a normal.

struct Frame {
  Vec3 tangent, bitangent, normal;

  PT_HD Vec3 to_world(const Vec3& local) const {
    return weighted_sum(local, tangent, bitangent, normal);
  }
  PT_HD Vec3 to_local(const Vec3& world) const {
    return {dot(world, tangent), dot(world, bitangent), dot(world, normal)};
  }
};

/// Branch-free and continuous but for the z = 0 crossing; `n` has unit length.
/// Duff et al. 2017, 'Building an Orthonormal Basis, Revisited', JCGT 6(1).
PT_HD Frame make_frame(const Vec3& n) {
  const float sign = copysignf(1.0f, n.z);
  const float a = -approximate_inverse(sign + n.z);
  const float b = n.x * n.y * a;
  return {{fused_multiply_add(sign * n.x * n.x, a, 1.0f), sign * b, -sign * n.x},
          {b, fused_multiply_add(n.y * n.y, a, sign), -n.y},
          n};
}

/// The frame whose tangent is the part of `dp_du` across the normal; any, where there is none.
PT_HD Frame make_frame(const Vec3& n, const Vec3& dp_du) {
  const Vec3 across = add_scaled(dp_du, -dot(n, dp_du), n);
  const float length2 = dot(across, across);
  if (!(length2 > 1e-12f * dot(dp_du, dp_du))) return make_frame(n);
  const Vec3 tangent = normalize(across);
  return {tangent, glm::cross(n, tangent), n};
}

}  // namespace pt
