// The spheres and quads of a scene as arrays; one primitive's intersection by number; boxes.
#pragma once

#include "common/geometry/bounds.h"
#include "common/geometry/motion.h"
#include "common/geometry/quad.h"
#include "common/geometry/sphere.h"
#include "common/platform/platform.h"

namespace pt {

/// Four spheres in half precision, two in each word (32 bytes), for the first pass of brute force
/// on CUDA.
struct alignas(16) HalfSpheres {
  static constexpr std::uint32_t count = 4;
  std::uint32_t x[2], y[2], z[2], radius_squared[2];
};

/// Numbered spheres first: primitive i is spheres[i] or quads[i - sphere_count].
struct Primitives {
  const Sphere* spheres = nullptr;
  const Quad* quads = nullptr;
  std::uint32_t sphere_count = 0;
  std::uint32_t quad_count = 0;
  // The spheres once more, for the pass that tests them all: relative to `scan_center`, widened by
  // more than that test's rounding error, filled up to a multiple of four with ones that no ray
  // hits.
  const Sphere* scan = nullptr;
  std::uint32_t scan_count = 0;
  Vec3 scan_center = Vec3(0.0f);
  // And once more, for the same pass on CUDA. They may lie elsewhere (SceneMemory).
  const HalfSpheres* halves = nullptr;
  std::uint32_t half_count = 0;
  float half_scale = 1.0f;

  PT_HD std::uint32_t count() const { return sphere_count + quad_count; }
  PT_HD bool is_sphere(std::uint32_t primitive) const { return primitive < sphere_count; }
  PT_HD const Quad& quad(std::uint32_t primitive) const { return quads[primitive - sphere_count]; }
};

/// Keeps the nearer of `hit` and an intersection at `t`; `t` <= 0 is none. Of two at the same
/// distance the lower number wins, so that the order of the tests does not matter.
PT_HD void keep_nearer(Hit& hit, float t, std::uint32_t primitive) {
  if (t > 0.0f && (t < hit.t || (t == hit.t && primitive < hit.primitive))) {
    hit.t = t;
    hit.primitive = primitive;
  }
}

PT_HD float primitive_distance(const Primitives& primitives, std::uint32_t i, const Ray& ray) {
  if (!primitives.is_sphere(i)) return quad_distance(primitives.quad(i), ray);
  return sphere_distance(load_wide(&primitives.spheres[i]), ray);
}

// Spheres that move, where they are at a time.

PT_HD bool moves(const Motion& motion, std::uint32_t sphere) {
  return motion.spheres != nullptr && motion.spheres[sphere].track.moves();
}

/// The pose of a sphere that moves.
PT_HD Affine sphere_pose(const Motion& motion, std::uint32_t sphere, float time) {
  return pose_at(motion.segments, motion.spheres[sphere].track, time);
}

/// A motion keeps its radius.
PT_HD Sphere sphere_at(const Primitives& primitives, std::uint32_t i, const Motion& motion,
                       float time) {
  Sphere sphere = load_wide(&primitives.spheres[i]);
  if (moves(motion, i))
    sphere.center = sphere_pose(motion, i, time).point(motion.spheres[i].center);
  return sphere;
}

/// Primitives at a time, for traversal.
struct MovingPrimitives {
  const Primitives& all;
  const Motion& motion;
  float time;
};

PT_HD float primitive_distance(const MovingPrimitives& primitives, std::uint32_t i,
                               const Ray& ray) {
  const Primitives& all = primitives.all;
  if (!all.is_sphere(i)) return quad_distance(all.quad(i), ray);
  return sphere_distance(sphere_at(all, i, primitives.motion, primitives.time), ray);
}

PT_HD SurfacePoint surface_point(const Primitives& primitives, const Ray& ray, const Hit& hit) {
  return primitives.is_sphere(hit.primitive)
             ? sphere_surface(load_wide(&primitives.spheres[hit.primitive]), ray, hit.t)
             : quad_surface(primitives.quad(hit.primitive), ray, hit.t);
}

PT_HD Bounds sphere_bounds(const Sphere& sphere) {
  return {sphere.center - sphere.radius(), sphere.center + sphere.radius()};
}

PT_HD Bounds quad_bounds(const Quad& quad) {
  Bounds bounds;
  for (int i = 0; i < 4; ++i) {
    bounds.grow(quad.corner + static_cast<float>(i & 1) * quad.edge_a +
                static_cast<float>(i >> 1) * quad.edge_b);
  }
  return bounds;
}

}  // namespace pt
