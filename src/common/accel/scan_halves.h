// Rays as the scans of brute force (traverse_brute.h) see spheres: in single precision, and in half
// precision, which tests two spheres by each instruction.
#pragma once

#include <type_traits>

#include "common/geometry/primitives.h"
#include "common/geometry/sphere.h"
#include "common/math/transform.h"

namespace pt {

/// A ray as seen along its own direction: what lies on it lies at the origin of a plane. A sphere's
/// centre falls on the point (dot(x_axis, centre) - x, dot(y_axis, centre) - y) of that plane, and
/// the line meets the sphere when this point is within the radius: nine operations per sphere, less
/// than any test in three dimensions.
class ProjectedRay {
 public:
  PT_HD ProjectedRay(const Ray& ray, const Vec3& scan_center) {
    const Frame frame = make_frame(ray.direction);
    const Vec3 origin = ray.origin - scan_center;
    x_axis_ = frame.tangent;
    y_axis_ = frame.bitangent;
    x_ = dot_from_x(x_axis_, origin);
    y_ = dot_from_x(y_axis_, origin);
  }

  PT_HD const Vec3& x_axis() const { return x_axis_; }
  PT_HD const Vec3& y_axis() const { return y_axis_; }
  PT_HD float x() const { return x_; }
  PT_HD float y() const { return y_; }

  /// Negative when the line misses the sphere, one of Primitives::scan.
  PT_HD float nearness(const Sphere& sphere) const {
    const Vec3& c = sphere.center;
    const auto along = [&c](const Vec3& axis, float of_ray) {
      const float from_z = fused_multiply_add(c.z, axis.z, -of_ray);
      return fused_multiply_add(c.x, axis.x, fused_multiply_add(c.y, axis.y, from_z));
    };
    const float x = along(x_axis_, x_), y = along(y_axis_, y_);
    return fused_multiply_add(-y, y, fused_multiply_add(-x, x, sphere.radius_squared));
  }

 private:
  Vec3 x_axis_, y_axis_;
  float x_, y_;
};

// Half precision. prepare_half_spheres.h explains why it loses no hit.

inline constexpr std::uint32_t half_chunk = 32;
inline constexpr std::uint32_t half_groups = half_chunk / HalfSpheres::count;

/// How many groups the chunk of 32 spheres has that begins with group `first` of `count`.
PT_HD std::uint32_t groups_of_chunk(std::uint32_t first, std::uint32_t count) {
  return count - first < half_groups ? count - first : half_groups;
}

/// A bit of a chunk's candidates belongs to this sphere of the chunk. A chunk of n groups has its
/// first n spheres in the highest byte, one of each group, from the highest bit on, the next n in
/// the byte below: sphere (3 - byte) n + 7 - bit of the byte.
PT_HD std::uint32_t half_sphere_index(std::uint32_t bit, std::uint32_t groups) {
  return (bit >> 3) * (half_groups - groups) + (3 * groups + 7 - bit);
}

/// Where sphere i lies: in which group, and which byte of sign_bytes is its own.
struct HalfIndex {
  std::uint32_t group;
  int byte;
};
PT_HD HalfIndex half_index(std::uint32_t i, std::uint32_t count) {
  const std::uint32_t first = i / half_chunk * half_groups, groups = groups_of_chunk(first, count);
  const std::uint32_t index = i % half_chunk;
  return {first + index % groups, 3 - static_cast<int>(index / groups)};
}

/// A ProjectedRay for two spheres at once.
class HalfProjectedRay {
 public:
  /// `scale`: that of the spheres.
  PT_HD HalfProjectedRay(const ProjectedRay& ray, float scale)
      : x_(ray.x_axis(), -scale * ray.x()), y_(ray.y_axis(), -scale * ray.y()) {}

  /// ProjectedRay::nearness of two of the four.
  PT_HD std::uint32_t nearness(const HalfSpheres& s, int pair) const {
    const std::uint32_t x = x_.of(s.x[pair], s.y[pair], s.z[pair]);
    const std::uint32_t y = y_.of(s.x[pair], s.y[pair], s.z[pair]);
    return multiply_add_halves(negate_halves(y), y,
                               multiply_add_halves(negate_halves(x), x, s.radius_squared[pair]));
  }

 private:
  struct Coordinate {
    std::uint32_t x, y, z, constant;

    PT_HD Coordinate(const Vec3& axis, float first)
        : x(pack_halves(axis.x, axis.x)),
          y(pack_halves(axis.y, axis.y)),
          z(pack_halves(axis.z, axis.z)),
          constant(pack_halves(first, first)) {}

    PT_HD std::uint32_t of(std::uint32_t cx, std::uint32_t cy, std::uint32_t cz) const {
      return multiply_add_halves(cx, x,
                                 multiply_add_halves(cy, y, multiply_add_halves(cz, z, constant)));
    }
  };

  Coordinate x_, y_;
};

/// The candidates among the groups [first, first + 8) of `count`; see half_index.
template <class First>
PT_HD std::uint32_t half_candidates(const HalfSpheres* groups, First first, std::uint32_t count,
                                    const HalfProjectedRay& ray) {
  const auto scan = [&](auto is_full) {
    std::uint32_t candidates = 0;
    PT_UNROLL(8)
    for (std::uint32_t group = 0; group < half_groups; ++group) {
      if (is_full || first + group < count) {
        const HalfSpheres spheres = load_wide(groups + first + group);
        const std::uint32_t missed = sign_bytes(ray.nearness(spheres, 0), ray.nearness(spheres, 1));
        candidates |= ~missed & 0x80808080u >> group;
      }
    }
    return candidates;
  };
  // Without a branch for each group the loads of one overlap with the arithmetic of another.
  if (first + half_groups <= count) return scan(std::true_type{});
  return scan(std::false_type{});
}

}  // namespace pt
