// Tests every primitive: the paper's way, and for a few dozen spheres the fastest one.
#pragma once

#include "common/geometry/primitives.h"
#include "common/math/frame.h"

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
    x_ = glm::dot(x_axis_, origin);
    y_ = glm::dot(y_axis_, origin);
  }

  /// Negative when the line misses the sphere, one of Primitives::scan.
  PT_HD float nearness(const Sphere& sphere) const {
    const Vec3& c = sphere.center;
    const float x = c.x * x_axis_.x + (c.y * x_axis_.y + (c.z * x_axis_.z - x_));
    const float y = c.x * y_axis_.x + (c.y * y_axis_.y + (c.z * y_axis_.z - y_));
    return sphere.radius_squared - x * x - y * y;
  }

 private:
  Vec3 x_axis_, y_axis_;
  float x_, y_;
};

inline constexpr int scan_group = 4;  ///< scanned spheres come in groups of this size
inline constexpr int scan_chunk = 32;

/// Bit 31 - j is set when the ray may meet spheres[first + j], 0 <= j < 32; `first` < `count`, a
/// multiple of scan_group. One pass without branches finds the candidates; the few that there are
/// come after, each thread turning to its own. Testing and resolving in one loop would make every
/// thread of a warp wait whenever any of them has a candidate, which for scattered rays is nearly
/// always. Where `first` is a constant and the spheres are a kernel's parameter, the tests need no
/// load: their operands come straight from the constant bank.
template <class First>
PT_HD std::uint32_t sphere_candidates(const Sphere* spheres, First first, std::uint32_t count,
                                      const ProjectedRay& ray) {
  std::uint32_t missed = 0;
  PT_UNROLL(8)
  for (std::uint32_t group = 0; group < scan_chunk; group += scan_group) {
    if (first + group < count) {
      PT_UNROLL(4)
      for (std::uint32_t j = 0; j < scan_group; ++j) {
        missed = shift_in_sign(missed, ray.nearness(load_wide(spheres + first + group + j)));
      }
    } else {
      missed = ~(~missed << scan_group);
    }
  }
  return ~missed;
}

/// Calls visit(distance, primitive) for the candidates until it returns true.
template <class Visit>
PT_HD bool resolve_candidates(const Primitives& primitives, std::uint32_t first,
                              std::uint32_t candidates, const Ray& ray, Visit&& visit) {
  while (candidates != 0) {
    lanes_of(ray).count(LanePoint::primitive);
    const int j = count_leading_zeros(candidates);
    candidates &= ~(0x80000000u >> j);
    const std::uint32_t primitive = first + j;
    if (primitive >= primitives.sphere_count) return false;  // a ray that is NaN meets fillers, too
    if (visit(sphere_distance(load_wide(&primitives.spheres[primitive]), ray), primitive)) {
      return true;
    }
  }
  return false;
}

/// Calls visit(distance, primitive) for every intersection until it returns true.
template <class Visit>
PT_HD bool for_each_intersection(const Primitives& primitives, const Ray& ray, Visit&& visit) {
  const ProjectedRay projected(ray, primitives.scan_center);
  const std::uint32_t count = primitives.scan_count;
  const auto chunk = [&](auto first) {
    if (first >= count) return false;
    const std::uint32_t candidates = sphere_candidates(primitives.scan, first, count, projected);
    return resolve_candidates(primitives, first, candidates, ray, visit);
  };
  if (chunk(std::integral_constant<std::uint32_t, 0>{})) return true;
  if (chunk(std::integral_constant<std::uint32_t, scan_chunk>{})) return true;
  for (std::uint32_t first = 2 * scan_chunk; first < count; first += scan_chunk) {
    if (chunk(first)) return true;
  }
  for (std::uint32_t i = 0; i < primitives.quad_count; ++i) {
    lanes_of(ray).count(LanePoint::primitive);
    if (visit(quad_distance(primitives.quads[i], ray), primitives.sphere_count + i)) return true;
  }
  return false;
}

PT_HD Hit closest_hit_brute(const Primitives& primitives, const Ray& ray) {
  Hit hit;
  for_each_intersection(primitives, ray, [&](float t, std::uint32_t primitive) {
    keep_nearer(hit, t, primitive);
    return false;
  });
  return hit;
}

/// Whether anything lies on the ray nearer than `distance`.
PT_HD bool any_hit_brute(const Primitives& primitives, const Ray& ray, float distance) {
  return for_each_intersection(primitives, ray,
                               [&](float t, std::uint32_t) { return t > 0.0f && t < distance; });
}

}  // namespace pt
