// Rays in shared memory that a warp has made ready for its lanes.
#pragma once

#include "common/accel/ray_record.h"
#include "common/accel/trace_cuda/cwbvh_step.cuh"
#include "common/accel/traverse_cwbvh.h"

namespace pt {

/// A ray with all that traversal computes from it beforehand.
struct PreparedRay {
  Vec3 origin;
  float t_min;
  Vec3 inverse;
  float t_max;  ///< negative: not to be traced, a miss
  TriangleRay triangles;
  std::uint32_t id;
  std::uint32_t octant;       ///< bit `axis`: the direction is negative
  std::uint32_t root_misses;  ///< after meet_root: missed_slots
};

/// 32 prepared rays in shared memory. Preparing takes a hundred instructions: done for 32 rays at
/// once, with all lanes, it costs a third of what it costs whenever some lanes need a ray.
class PreparedRays {
 public:
  __device__ void store(unsigned lane, const RayRecord& record, std::uint32_t id) {
    const Ray ray = record.ray();
    const CwbvhRay r = make_cwbvh_ray(ray);
    const TriangleRay& t = r.triangles;
    const float t_max = is_traceable(ray) ? record.t_max : -1.0f;
    part_[0][lane] = {r.origin.x, r.origin.y, r.origin.z, record.t_min};
    part_[1][lane] = {r.inverse.x, r.inverse.y, r.inverse.z, t_max};
    part_[2][lane] = {t.x_axis.x, t.x_axis.y, t.x_axis.z, __uint_as_float(id)};
    part_[3][lane] = {t.y_axis.x, t.y_axis.y, t.y_axis.z, __uint_as_float(r.octant | t.axis << 3)};
    inverse_[lane] = t.inverse;
  }

  /// The step at the root, with which all rays begin. Taken for 32 rays at once it has all lanes,
  /// and reads one node.
  __device__ void meet_root(unsigned lane, const TriangleTree& tree) {
    const float4 a = part_[0][lane], b = part_[1][lane];
    const Vec3 origin = {a.x, a.y, a.z}, inverse = {b.x, b.y, b.z};
    const float t_max = b.w;
    const CwbvhWords root = load_cwbvh_words(&tree.cwbvh[tree.root]);
    std::uint32_t misses = 0xffu;
    if (t_max > 0.0f) {
      misses = missed_slots(root, origin, inverse, select_near_planes(inverse), t_max);
    }
    float& word = part_[3][lane].w;
    word = __uint_as_float(__float_as_uint(word) | misses << 5);
  }

  __device__ PreparedRay load(unsigned lane) const {
    const float4 a = part_[0][lane], b = part_[1][lane], c = part_[2][lane], d = part_[3][lane];
    const Vec3 origin = {a.x, a.y, a.z};
    const std::uint32_t word = __float_as_uint(d.w);
    return {origin,
            a.w,
            {b.x, b.y, b.z},
            b.w,
            {origin, {c.x, c.y, c.z}, {d.x, d.y, d.z}, inverse_[lane], word >> 3 & 3u},
            __float_as_uint(c.w),
            word & 7u,
            word >> 5};
  }

 private:
  float4 part_[4][32];
  float inverse_[32];
};

// Scenes with instances: rays of the world.

/// A ray before anything is computed from it: each instance sees another one.
struct WorldRay {
  Vec3 origin;
  float t_min;
  Vec3 direction;
  float t_max;  ///< negative: not to be traced, a miss
  std::uint32_t id;
};

/// 32 rays that a warp holds ready for its lanes.
class WorldRays {
 public:
  __device__ void store(unsigned lane, const RayRecord& record, std::uint32_t id) {
    const Vec3 &o = record.origin, &d = record.direction;
    origin_[lane] = {o.x, o.y, o.z, record.t_min};
    direction_[lane] = {d.x, d.y, d.z, is_traceable(record.ray()) ? record.t_max : -1.0f};
    id_[lane] = id;
  }

  __device__ WorldRay load(unsigned lane) const {
    const float4 o = origin_[lane], d = direction_[lane];
    return {{o.x, o.y, o.z}, o.w, {d.x, d.y, d.z}, d.w, id_[lane]};
  }

 private:
  float4 origin_[32], direction_[32];
  std::uint32_t id_[32];
};

/// What lanes need now and then, by lane, beside registers; each sees its own alone.
struct InstancedLanes {
  float4 origin[32];               ///< of the ray in the world; where it enters the instance
  float4 inverse[32];              ///< likewise, as the tree needs it; where it leaves the instance
  float4 direction[32];            ///< likewise; t_min
  std::uint32_t instance[32];      ///< where the lane is
  std::uint32_t slot[32];          ///< of the best hit; no_primitive
  std::uint32_t hit_instance[32];  ///< likewise
};

}  // namespace pt
