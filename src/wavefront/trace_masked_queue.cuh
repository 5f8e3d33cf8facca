// The rays of a queue, traced by persistent warps, in scenes with masks.
#pragma once

#include "common/transport/mask_hides.h"
#include "wavefront/trace_queue.cuh"

namespace pt {

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

/// QueuedPaths or QueuedShadowRays of a scene without spheres and instances.
template <class Rays>
struct MaskedRays : Rays {
  using Query = QueryWithKey<typename Rays::Query>;
  Scene scene;
  SampleBuffer names;  ///< gives a path's id by its index

  __device__ std::uint32_t fetch(unsigned lane, ReservedRays& reserved, RayRecord& record,
                                 int& count) const {
    const std::uint32_t first = Rays::fetch(lane, reserved, record, count);
    if (static_cast<int>(lane) < count) {
      const auto path_key = [this](std::uint32_t path_index) {
        return path_hash<MaskedTraits>(scene, names.id_of(path_index));
      };
      record.t_min =
          __uint_as_float(this->key_of(scene, this->rays.slot(first + lane), path_key, record));
    }
    return first;
  }

  __device__ bool hides(const Query& query, std::uint32_t slot, const TriangleHit& hit) const {
    return mask_hides(MaskView(scene), scene.triangles.triangles, query.key(), slot, hit.b1,
                      hit.b2);
  }

 private:
  using MaskedTraits = Traits<Accel::cwbvh, Geometry::mixed, Lighting::sky, true>;
};

}  // namespace pt
