// The rays of a queue, traced by persistent warps: for wide trees, where a thread per ray would
// wait for the slowest of its warp.
#pragma once

#include "common/accel/trace_cuda/instanced_lane.cuh"
#include "common/accel/trace_cuda/persistent_cwbvh.cuh"
#include "common/device/cuda/stage_stamp.cuh"
#include "common/transport/mask.h"
#include "wavefront/wave_buffers.h"

namespace pt {

/// What both kinds of rays share: `ray_index` is an index into the stage's queue.
struct QueuedRays {
  PathPool pool;
  StageQueues queues;
  std::uint32_t* next;  ///< rays of the queue that are handed out so far
  PT_LANE_COUNTER;      ///< the scene's

  __device__ std::uint32_t slot(std::uint32_t ray_index) const { return queues.slots[ray_index]; }

  /// See PersistentTracer. `load(slot)` gives the ray.
  template <class Load>
  __device__ std::uint32_t fetch(unsigned lane, ReservedRays& reserved, int& count,
                                 Load&& load) const {
    const std::uint32_t first = reserve_rays(next, *queues.count, lane, reserved, count);
    if (static_cast<int>(lane) < count) load(slot(first + lane));
    return first;
  }
};

/// The next ray of each path; its hit is stored.
struct QueuedPaths {
  using Query = ClosestTriangle;
  QueuedRays rays;

  __device__ std::uint32_t fetch(unsigned lane, ReservedRays& reserved, RayRecord& record,
                                 int& count) const {
    return rays.fetch(lane, reserved, count, [&](std::uint32_t slot) {
      const Ray ray = rays.pool.load_ray(slot);
      record = {ray.origin, 0.0f, ray.direction, infinite_distance};
    });
  }

  __device__ void finish(std::uint32_t ray_index, const ClosestTriangle& query) const {
    rays.pool.store_hit(rays.slot(ray_index), query.result());
  }

  __device__ LaneCounter lanes(std::uint32_t ray_index) const {
    return rays.pool.path_lanes(lanes_of(rays), rays.slot(ray_index));
  }

  __device__ std::uint32_t path_index(std::uint32_t slot) const {
    return rays.pool.load_path_id(slot).index;
  }

  /// For masks: the key of the ray, which it may end. `path_key` gives a path's key by its index.
  template <class PathKey>
  __device__ std::uint32_t key_of(const Scene& scene, std::uint32_t slot, PathKey&& path_key,
                                  RayRecord& record) const {
    const PathState path = rays.pool.load_path_id(slot);
    const std::uint32_t key = next_ray_key(scene, path_key(path.index), path.rays);
    record.t_max = ray_length(scene, record.direction, key);
    return key;
  }
};

/// Shadow rays; their contribution is added to the path's sample.
struct QueuedShadowRays {
  using Query = AnyTriangle;
  QueuedRays rays;
  SampleBuffer samples;

  __device__ std::uint32_t fetch(unsigned lane, ReservedRays& reserved, RayRecord& record,
                                 int& count) const {
    return rays.fetch(lane, reserved, count, [&](std::uint32_t slot) {
      std::uint32_t path_index;
      const ShadowRay shadow = rays.pool.load_shadow(slot, path_index);
      record = {shadow.ray.origin, 0.0f, shadow.ray.direction, shadow.distance};
    });
  }

  __device__ void finish(std::uint32_t ray_index, const AnyTriangle& query) const {
    if (query.result()) return;
    std::uint32_t path;
    const ShadowRay shadow = rays.pool.load_shadow(rays.slot(ray_index), path);
    add_radiance(samples, path, shadow.radiance);
  }

  __device__ LaneCounter lanes(std::uint32_t ray_index) const {
    return rays.pool.shadow_lanes(lanes_of(rays), rays.slot(ray_index));
  }

  __device__ std::uint32_t path_index(std::uint32_t slot) const {
    std::uint32_t index;
    rays.pool.load_shadow(slot, index);
    return index;
  }

  template <class PathKey>
  __device__ std::uint32_t key_of(const Scene& scene, std::uint32_t slot, PathKey&& path_key,
                                  RayRecord&) const {
    return shadow_ray_key(scene, path_key(path_index(slot)), rays.pool.load_shadow_rays(slot));
  }
};

template <class Lane, class Rays>
__global__ void __launch_bounds__(persistent_block<Lane>, persistent_blocks_least<Lane>)
    trace_rays_of_queue(const __grid_constant__ TriangleTree tree,
                        const __grid_constant__ Rays rays, StageId stage, StageClock* clock) {
  __shared__ PersistentMemory<Lane, persistent_block<Lane>> memory;
  stamp_first_thread(clock, stage);
  if (*rays.rays.queues.count == 0) return;
  trace_persistent<Lane>(tree, memory, rays);
}

/// Query, asking masks. Rays of paths begin at 0, so the ray's record has its key
/// (transport/mask.h) where others have t_min.
template <class Query>
class QueryWithKey : public Query {
 public:
  static constexpr bool has_masks = true;

  __device__ QueryWithKey(float key, float t_max) : Query(0.0f, t_max), key_(key) {}
  __device__ std::uint32_t key() const { return __float_as_uint(key_); }

 private:
  float key_;
};

/// QueuedPaths or QueuedShadowRays whose paths have names.
template <class Rays>
struct NamedRays : Rays {
  Scene scene;
  SampleBuffer names;  ///< gives a path's id by its index

  /// `word(slot, record)` is what the ray's record has instead of t_min.
  template <class Word>
  __device__ std::uint32_t fetch_with(unsigned lane, ReservedRays& reserved, RayRecord& record,
                                      int& count, Word&& word) const {
    const std::uint32_t first = Rays::fetch(lane, reserved, record, count);
    if (static_cast<int>(lane) < count) record.t_min = word(this->rays.slot(first + lane), record);
    return first;
  }
};

/// Those of a scene without spheres and instances.
template <class Rays>
struct MaskedRays : NamedRays<Rays> {
  using Query = QueryWithKey<typename Rays::Query>;

  __device__ std::uint32_t fetch(unsigned lane, ReservedRays& reserved, RayRecord& next,
                                 int& count) const {
    const auto path_key = [this](std::uint32_t path_index) {
      return path_hash<MaskedTraits>(this->scene, this->names.id_of(path_index));
    };
    return this->fetch_with(
        lane, reserved, next, count, [&](std::uint32_t slot, RayRecord& record) {
          return __uint_as_float(this->key_of(this->scene, slot, path_key, record));
        });
  }

  __device__ bool hides(const Query& query, std::uint32_t slot, const TriangleHit& hit) const {
    return mask_hides(MaskView(this->scene), this->scene.triangles.triangles, query.key(), slot,
                      hit.b1, hit.b2);
  }

 private:
  using MaskedTraits = Traits<Accel::cwbvh, Geometry::mixed, Lighting::sky, true>;
};

/// Those of a scene that moves, without spheres and masks.
template <class Rays>
struct MovingRays : NamedRays<Rays> {
  using Query = TimedQuery<typename Rays::Query>;

  __device__ std::uint32_t fetch(unsigned lane, ReservedRays& reserved, RayRecord& next,
                                 int& count) const {
    return this->fetch_with(
        lane, reserved, next, count, [this](std::uint32_t slot, const RayRecord&) {
          return shutter_time(this->scene, this->names.id_of(this->path_index(slot)));
        });
  }

  __device__ InstanceRecord placed(const InstanceRecord& instance, float time) const {
    return placed_at(instance, *this->scene.motion, time);
  }
};

}  // namespace pt
