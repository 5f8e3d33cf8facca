// Rays and hits as they lie in files and in device memory.
#pragma once

#include "common/accel/triangle_query.h"

namespace pt {

/// Hits count for t_min < t < t_max. The direction's length is the unit of t.
struct alignas(16) RayRecord {
  Vec3 origin;
  float t_min;
  Vec3 direction;
  float t_max;

  PT_HD Ray ray() const { return {origin, direction}; }
};
static_assert(sizeof(RayRecord) == 32);

/// Closest hit: t, or -1 for a miss, and the triangle's number in the mesh, or no_primitive. Any
/// hit: t is 0 for an occluded ray, -1 for a free one.
struct HitRecord {
  float t;
  std::uint32_t primitive;
};
static_assert(sizeof(HitRecord) == 8);

PT_HD HitRecord hit_record(const TriangleTree& tree, const ClosestTriangle& query) {
  const Hit hit = query.result();
  if (hit.is_miss()) return {-1.0f, no_primitive};
  return {hit.t, tree.triangles[hit.primitive].id};
}

PT_HD HitRecord hit_record(const TriangleTree&, const ClosestTriangleId& query) {
  return query.is_miss() ? HitRecord{-1.0f, no_primitive} : HitRecord{query.t(), query.id()};
}

PT_HD HitRecord hit_record(const TriangleTree&, const AnyTriangle& query) {
  return {query.result() ? 0.0f : -1.0f, no_primitive};
}

enum class RayType : std::uint32_t { closest = 0, any = 1 };

/// Rays and hits in device memory. `next` counts the rays handed out to persistent warps; it is 0
/// before a launch.
struct RayArrays {
  const RayRecord* rays = nullptr;
  HitRecord* hits = nullptr;
  std::uint32_t count = 0;
  std::uint32_t* next = nullptr;
};

/// Numbers [next, end) of rays that a warp has reserved; empty at first. In shared memory.
struct ReservedRays {
  std::uint32_t next, end;
};

}  // namespace pt
