// Rays that are hard on trees over triangles, each kind in its own way.
#pragma once

#include <functional>
#include <ostream>

#include "accel/triangle_meshes.h"
#include "common/geometry/bounds.h"
#include "common/geometry/ray.h"

namespace pt {

/// A mesh to aim at.
class Target {
 public:
  explicit Target(const Mesh& mesh) : mesh_(mesh) {
    for (const TriangleIndices& t : mesh.triangles) {
      for (const std::uint32_t v : t.v) bounds_.grow(mesh.positions[v]);
    }
  }
  float size() const { return std::max(1e-6f, max_abs(bounds_.max - bounds_.min)); }
  Vec3 anywhere(TestRandom& random) const {
    return bounds_.center() + point_in_cube(random, 0.7 * size());
  }
  Vec3 vertex(TestRandom& random) const { return corner(pick(random), random.below(3)); }
  Vec3 on_edge(TestRandom& random) const {
    const TriangleIndices& t = pick(random);
    const std::uint32_t i = random.below(3);
    const Vec3 a = corner(t, i), b = corner(t, (i + 1) % 3);
    return random.bits() % 4 == 0 ? 0.5f * (a + b) : a + random.unit() * (b - a);
  }
  Vec3 on_surface(TestRandom& random) const {
    const TriangleIndices& t = pick(random);
    const float a = random.unit(), b = (1 - a) * random.unit();
    return corner(t, 0) + a * (corner(t, 1) - corner(t, 0)) + b * (corner(t, 2) - corner(t, 0));
  }
  /// In the plane of a triangle.
  Vec3 along_surface(TestRandom& random) const {
    const TriangleIndices& t = pick(random);
    const float angle = 6.28f * random.unit();
    return std::cos(angle) * (corner(t, 1) - corner(t, 0)) +
           std::sin(angle) * (corner(t, 2) - corner(t, 0));
  }

 private:
  const TriangleIndices& pick(TestRandom& random) const {
    return mesh_.triangles[random.below(static_cast<std::uint32_t>(mesh_.triangles.size()))];
  }
  const Vec3& corner(const TriangleIndices& t, std::uint32_t i) const {
    return mesh_.positions[t.v[i]];
  }

  const Mesh& mesh_;
  Bounds bounds_;
};

inline Ray ray_to(const Vec3& from, const Vec3& to) {
  const glm::dvec3 d = glm::dvec3(to) - glm::dvec3(from);
  const double length = glm::length(d);
  return {from, length > 0 ? Vec3(d / length) : Vec3(0, 0, 1)};
}

struct RayKind {
  const char* name;
  std::function<Ray(const Target&, TestRandom&)> make;
};
inline void PrintTo(const RayKind& kind, std::ostream* out) { *out << kind.name; }

inline Ray axis_ray(const Vec3& to, TestRandom& random, float length) {
  Ray ray{to, Vec3(random.bits() % 2 ? 0.0f : -0.0f)};
  const int axis = static_cast<int>(random.below(3));
  ray.direction[axis] = random.bits() % 2 ? 1.0f : -1.0f;
  ray.origin -= length * ray.direction;
  return ray;
}

inline const RayKind ray_kinds[] = {
    {"anywhere",
     [](const Target& t, TestRandom& r) { return ray_to(t.anywhere(r), t.anywhere(r)); }},
    {"at_surfaces",
     [](const Target& t, TestRandom& r) { return ray_to(t.anywhere(r), t.on_surface(r)); }},
    {"from_surfaces",
     [](const Target& t, TestRandom& r) { return ray_to(t.on_surface(r), t.on_surface(r)); }},
    {"through_vertices",
     [](const Target& t, TestRandom& r) { return ray_to(t.anywhere(r), t.vertex(r)); }},
    {"between_vertices",
     [](const Target& t, TestRandom& r) { return ray_to(t.vertex(r), t.vertex(r)); }},
    {"through_edges",
     [](const Target& t, TestRandom& r) { return ray_to(t.anywhere(r), t.on_edge(r)); }},
    {"along_axes",
     [](const Target& t, TestRandom& r) { return axis_ray(t.on_surface(r), r, t.size()); }},
    {"along_axes_through_vertices",
     [](const Target& t, TestRandom& r) { return axis_ray(t.vertex(r), r, t.size()); }},
    {"grazing",
     [](const Target& t, TestRandom& r) {
       const Vec3 to = t.on_surface(r), along = t.along_surface(r);
       return ray_to(to - 3.0f * along, to + 1e-6f * t.size() * point_in_cube(r, 1));
     }},
    {"from_far_away",
     [](const Target& t, TestRandom& r) {
       const Vec3 away = t.size() * 1e5f * Vec3(r.direction());
       return ray_to(t.anywhere(r) + away, r.bits() % 2 ? t.vertex(r) : t.on_surface(r));
     }},
};

}  // namespace pt
