// Hands the rays of an array to persistent warps, and takes their hits.
#pragma once

#include "common/accel/triangle_query.h"
#include "common/trace/ray_record.h"

namespace pt {

/// Rays in device memory. `next` counts those handed out; it starts at 0.
struct RayArrays {
  const RayRecord* rays;
  HitRecord* hits;
  std::uint32_t count;
  std::uint32_t* next;
};

__device__ inline RayRecord load_ray(const RayRecord* ray) {
  const float4 a = __ldcs(reinterpret_cast<const float4*>(ray));
  const float4 b = __ldcs(reinterpret_cast<const float4*>(ray) + 1);
  return {{a.x, a.y, a.z}, a.w, {b.x, b.y, b.z}, b.w};
}

__device__ inline void store_hit(HitRecord* hit, float t, std::uint32_t primitive) {
  __stcs(reinterpret_cast<float2*>(hit), make_float2(t, __uint_as_float(primitive)));
}

__device__ inline void store_result(const TriangleTree& tree, const ClosestTriangle& query,
                                    HitRecord* record) {
  const Hit hit = query.result();
  const bool miss = hit.is_miss();
  store_hit(record, miss ? -1.0f : hit.t, miss ? no_primitive : tree.triangles[hit.primitive].id);
}

__device__ inline void store_result(const TriangleTree&, const AnyTriangle& query,
                                    HitRecord* record) {
  store_hit(record, query.result() ? 0.0f : -1.0f, no_primitive);
}

/// A thread's share of the array. Warps take `batch` rays at once: few atomic operations.
template <std::uint32_t batch>
class RayQueue {
 public:
  __device__ RayQueue(const TriangleTree& tree, const RayArrays& arrays)
      : tree_(tree), arrays_(arrays) {}

  /// No ray is left for this warp.
  __device__ bool is_dry() const { return next_ >= arrays_.count; }

  /// All threads of the warp call it together. False for a thread that wants a ray and gets none.
  __device__ bool fetch(bool wanted, Ray& ray, float& t_min, float& t_max) {
    const unsigned asking = __ballot_sync(0xffffffffu, wanted);
    const unsigned lane = threadIdx.x & 31;
    const std::uint32_t rank = __popc(asking & ((1u << lane) - 1));
    const std::uint32_t count = __popc(asking);
    const std::uint32_t left = end_ - next_;
    index_ = wanted ? next_ + rank : index_;
    next_ += count;
    if (count > left) {
      std::uint32_t first = 0;
      if (lane == 0) first = atomicAdd(arrays_.next, batch);
      first = __shfl_sync(0xffffffffu, first, 0);
      if (wanted && rank >= left) index_ = first + (rank - left);
      next_ = first + (count - left);
      end_ = first + batch;
    }
    if (!wanted || index_ >= arrays_.count) return false;
    const RayRecord record = load_ray(arrays_.rays + index_);
    ray = record.ray();
    t_min = record.t_min;
    t_max = record.t_max;
    return true;
  }

  template <class Query>
  __device__ void finish(const Query& query) {
    store_result(tree_, query, arrays_.hits + index_);
  }

 private:
  const TriangleTree& tree_;
  const RayArrays& arrays_;
  std::uint32_t index_ = 0;
  std::uint32_t next_ = 0, end_ = 0;  ///< the warp's share, the same in all of its threads
};

}  // namespace pt
