// Rays of the world for warps that trace scenes with instances, in shared memory.
#pragma once

#include "common/accel/ray_record.h"
#include "common/accel/traverse_cwbvh.h"

namespace pt {

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
