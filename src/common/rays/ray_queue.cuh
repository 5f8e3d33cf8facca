// Hands the rays of an array to persistent warps, and takes their hits.
#pragma once

#include "common/accel/trace_cuda/reserve_rays.cuh"

namespace pt {

__device__ inline RayRecord load_ray(const RayRecord* ray) {
  const float4 a = __ldcs(reinterpret_cast<const float4*>(ray));
  const float4 b = __ldcs(reinterpret_cast<const float4*>(ray) + 1);
  return {{a.x, a.y, a.z}, a.w, {b.x, b.y, b.z}, b.w};
}

__device__ inline void store_hit(HitRecord* hit, float t, std::uint32_t primitive) {
  __stcs(reinterpret_cast<float2*>(hit), make_float2(t, __uint_as_float(primitive)));
}

template <class Query>
__device__ void store_result(const TriangleTree& tree, const Query& query, HitRecord* record) {
  const HitRecord hit = hit_record(tree, query);
  store_hit(record, hit.t, hit.primitive);
}

/// A warp's share of the array; see reserve_rays.
class RayQueue {
 public:
  __device__ RayQueue(const TriangleTree& tree, const RayArrays& arrays)
      : tree_(tree), arrays_(arrays) {}

  /// See PersistentTracer.
  __device__ std::uint32_t fetch(unsigned lane, ReservedRays& reserved, RayRecord& ray,
                                 int& count) const {
    const std::uint32_t first = reserve_rays(arrays_.next, arrays_.count, lane, reserved, count);
    if (static_cast<int>(lane) < count) ray = load_ray(arrays_.rays + first + lane);
    return first;
  }

  template <class Query>
  __device__ void finish(std::uint32_t ray_id, const Query& query) const {
    store_result(tree_, query, arrays_.hits + ray_id);
  }

 private:
  const TriangleTree& tree_;
  const RayArrays& arrays_;
};

}  // namespace pt
