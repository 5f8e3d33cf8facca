// What a path's rays look for, where lanes side by side trace rays and shadow rays.
#pragma once

#include "common/accel/triangle_query.h"

namespace pt {

/// The closest hit of a path's ray, or any of a shadow ray, which ends with it.
class PathQuery : public ClosestTriangle {
 public:
  __device__ PathQuery(float t_min, float t_max, bool is_shadow = false)
      : ClosestTriangle(t_min, t_max), is_shadow_(is_shadow) {}

  __device__ bool is_shadow() const { return is_shadow_; }

  /// The same once it has hit nothing nearer than `t`, which is `primitive` or, without one, the
  /// end. For trees without instances.
  __device__ PathQuery resumed(const TriangleTree& tree, float t, std::uint32_t primitive) const {
    const bool has_hit = primitive != no_primitive;
    PathQuery query(0.0f, has_hit ? infinite_distance : t, is_shadow_);
    if (has_hit) query.offer(tree, t, primitive, 0);
    return query;
  }

  /// As AnyTriangle says: the first hit that counts lies nearer than t_max.
  __device__ bool offer_nearer(const TriangleTree& tree, const MetTriangle& a,
                               const MetTriangle& b) {
    ClosestTriangle::offer_nearer(tree, a, b);
    return is_shadow_ && !result().is_miss();
  }

 private:
  bool is_shadow_;
};

/// The same with masks, which depend on the ray's key (transport/mask.h).
class MaskedPathQuery : public PathQuery {
 public:
  static constexpr bool has_masks = true;

  __device__ MaskedPathQuery(float t_min, float t_max) : PathQuery(t_min, t_max) {}
  __device__ MaskedPathQuery(const PathQuery& query, std::uint32_t key)
      : PathQuery(query), key_(key) {}
  __device__ std::uint32_t key() const { return key_; }
  __device__ MaskedPathQuery resumed(const TriangleTree& tree, float t,
                                     std::uint32_t primitive) const {
    return {PathQuery::resumed(tree, t, primitive), key_};
  }

 private:
  std::uint32_t key_ = 0;
};

}  // namespace pt
