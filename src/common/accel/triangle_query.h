// What a traversal of triangles looks for: the closest hit, or any. And how a ray is prepared for
// it.
#pragma once

#include "common/accel/slab_test.h"
#include "common/accel/triangle_tree.h"
#include "common/geometry/motion.h"
#include "common/geometry/ray.h"

namespace pt {

/// A triangle that was met at `t`, NaN for not met.
struct MetTriangle {
  float t;
  std::uint32_t slot, id;
};

/// The closest hit with t_min < t < t_max. Of several at the same t the one of the lowest triangle
/// index wins, then of the lowest instance index, so that the result does not depend on the order
/// in which a structure finds them.
class ClosestTriangle {
 public:
  static constexpr bool has_masks = false;

  PT_HD ClosestTriangle(float t_min, float t_max) : t_min_(t_min) { hit_.t = t_max; }

  /// Boxes that the ray enters beyond this need no visit.
  PT_HD float t_max() const { return hit_.t; }
  PT_HD float t_min() const { return t_min_; }

  /// A triangle was met at `t`, NaN for none. True: there is no need to look any further.
  PT_HD bool offer(const TriangleTree& tree, float t, std::uint32_t slot, std::uint32_t instance) {
    if (t > t_min_ && t <= hit_.t && (t < hit_.t || wins_tie(tree, slot, instance))) {
      hit_ = {t, slot, instance};
    }
    return false;
  }

  /// Offers two triangles of a tree without instances.
  PT_HD bool offer_nearer(const TriangleTree& tree, const MetTriangle& a, const MetTriangle& b) {
    const bool nearer = b.t < a.t || (b.t == a.t && b.id < a.id);
    const bool second = !(a.t > t_min_) || (b.t > t_min_ && nearer);
    return offer(tree, second ? b.t : a.t, second ? b.slot : a.slot, 0);
  }

  PT_HD Hit result() const { return hit_.is_miss() ? Hit() : hit_; }

 private:
  PT_HD bool wins_tie(const TriangleTree& tree, std::uint32_t slot, std::uint32_t instance) const {
    if (hit_.is_miss()) return false;
    const std::uint32_t id = tree.triangles[slot].id, best = tree.triangles[hit_.primitive].id;
    if (id != best || tree.instance_count == 0) return id < best;
    return tree.instances[instance].index < tree.instances[hit_.instance].index;
  }

  float t_min_;
  Hit hit_;
};

/// As ClosestTriangle, for trees without instances, where nothing but t and the triangle's number
/// is asked for: the record of the hit need not be read again.
class ClosestTriangleId {
 public:
  static constexpr bool has_masks = false;

  PT_HD ClosestTriangleId(float t_min, float t_max) : t_min_(t_min), t_(t_max) {}

  PT_HD float t_max() const { return t_; }
  PT_HD float t_min() const { return t_min_; }

  PT_HD bool offer_nearer(const TriangleTree&, const MetTriangle& a, const MetTriangle& b) {
    offer(a);
    offer(b);
    return false;
  }

  PT_HD bool is_miss() const { return id_ == no_id; }
  PT_HD float t() const { return t_; }
  PT_HD std::uint32_t id() const { return id_; }

 private:
  static constexpr std::uint32_t no_id = 0xffffffffu;

  PT_HD void offer(const MetTriangle& met) {
    // As signed numbers, of which no_id is the least.
    const bool wins_tie = static_cast<std::int32_t>(met.id) < static_cast<std::int32_t>(id_);
    const bool is_nearer = met.t < t_ || (met.t == t_ && wins_tie);
    if (met.t > t_min_ && is_nearer) t_ = met.t, id_ = met.id;
  }

  float t_min_, t_;
  std::uint32_t id_ = no_id;
};

/// Whether there is a hit with t_min < t < t_max.
class AnyTriangle {
 public:
  static constexpr bool has_masks = false;

  PT_HD AnyTriangle(float t_min, float t_max) : t_min_(t_min), t_max_(t_max) {}

  PT_HD float t_max() const { return t_max_; }
  PT_HD float t_min() const { return t_min_; }

  PT_HD bool offer(const TriangleTree&, float t, std::uint32_t, std::uint32_t) {
    found_ = t > t_min_ && t < t_max_;
    return found_;
  }

  PT_HD bool offer_nearer(const TriangleTree&, const MetTriangle& a, const MetTriangle& b) {
    found_ = (a.t > t_min_ && a.t < t_max_) || (b.t > t_min_ && b.t < t_max_);
    return found_;
  }

  PT_HD bool result() const { return found_; }

 private:
  float t_min_, t_max_;
  bool found_ = false;
};

/// Whether a mask decides about a triangle that was met at `t`, NaN for not met: what the query
/// would not take it need not be asked about.
template <class Query>
PT_HD bool is_up_to_mask(const Query& query, const Triangle& triangle, float t) {
  return (triangle.attributes & TriangleAttributes::masked) != 0 && t > query.t_min() &&
         t <= query.t_max();
}

/// A query that ignores the holes of masked triangles. Mask has
///   bool hides(const Triangle&, const TriangleHit&, std::uint32_t instance) const
/// and is asked about masked triangles only. Only offer_slots() uses it.
template <class Query, class Mask>
class MaskedQuery : public Query {
 public:
  static constexpr bool has_masks = true;

  /// `more`: what Query asks for besides.
  template <class... More>
  PT_HD MaskedQuery(float t_min, float t_max, const Mask& mask, const More&... more)
      : Query(t_min, t_max, more...), mask_(mask) {}

  /// `t` is that of the hit, or where an instance's box has moved it.
  PT_HD bool hides(const Triangle& triangle, const TriangleHit& hit, float t,
                   std::uint32_t instance) const {
    return is_up_to_mask(*this, triangle, t) && mask_.hides(triangle, hit, instance);
  }

 private:
  Mask mask_;
};

/// A placed group of triangles as it lies at `time`.
PT_HD InstanceRecord placed_at(InstanceRecord instance, const Motion& motion, float time) {
  if (instance.track.moves())
    instance.to_object = inverse(pose_at(motion.segments, instance.track, time));
  return instance;
}

/// The triangle of a slot, its vertices where they are at `time`.
PT_HD Triangle triangle_at(const TriangleTree& tree, std::uint32_t slot, const Motion& motion,
                           float time) {
  if (motion.vertex_steps == 0) return load_wide(&tree.triangles[slot]);
  const VertexTime at = vertex_time(time, motion.vertex_steps);
  Triangle triangle = motion.triangles.of(tree.triangles, at.set, slot);
  const Triangle end = motion.triangles.of(tree.triangles, at.set + 1, slot);
  triangle.v0 = interpolate(triangle.v0, end.v0, at.part);
  triangle.v1 = interpolate(triangle.v1, end.v1, at.part);
  triangle.v2 = interpolate(triangle.v2, end.v2, at.part);
  return triangle;
}

/// A query about what lies where at `time`.
template <class Query>
class MovingQuery : public Query {
 public:
  static constexpr bool moves = true;

  PT_HD MovingQuery(float t_min, float t_max, const Motion& motion, float time)
      : Query(t_min, t_max), motion_(motion), time_(time) {}

  PT_HD InstanceRecord placed(const InstanceRecord& instance) const {
    return placed_at(instance, motion_, time_);
  }
  PT_HD Triangle triangle(const TriangleTree& tree, std::uint32_t slot) const {
    return triangle_at(tree, slot, motion_, time_);
  }
  /// Its boxes hold what they do at both sets of vertices around the time, and so all between.
  PT_HD Bvh2Node node(const TriangleTree& tree, std::uint32_t index) const {
    if (index >= motion_.nodes.count) return load_wide(&tree.bvh2[index]);
    const VertexTime at = vertex_time(time_, motion_.vertex_steps);
    Bvh2Node node = motion_.nodes.of(tree.bvh2, at.set, index);
    const Bvh2Node end = motion_.nodes.of(tree.bvh2, at.set + 1, index);
    const auto between = [&](const Vec4& a, const Vec4& b) {
      return Vec4(interpolate(a.x, b.x, at.part), interpolate(a.y, b.y, at.part),
                  interpolate(a.z, b.z, at.part), interpolate(a.w, b.w, at.part));
    };
    for (int i = 0; i < 2; ++i) node.xy[i] = between(node.xy[i], end.xy[i]);
    node.z = between(node.z, end.z);
    return node;
  }

 private:
  const Motion& motion_;
  float time_;
};

template <class Query>
inline constexpr bool is_moving_query = requires {
  Query::moves;
};

/// What a query sees of a slot, and of a node.
template <class Query>
PT_HD Triangle triangle_for(const Query& query, const TriangleTree& tree, std::uint32_t slot) {
  if constexpr (is_moving_query<Query>) return query.triangle(tree, slot);
  return load_wide(&tree.triangles[slot]);
}
template <class Query>
PT_HD Bvh2Node node_for(const Query& query, const TriangleTree& tree, std::uint32_t index) {
  if constexpr (is_moving_query<Query>) return query.node(tree, index);
  return load_wide(&tree.bvh2[index]);
}

/// A ray that is not finite or has no direction meets nothing. It must be sorted out before the
/// traversal, in which such a ray would pass every box.
PT_HD bool is_traceable(const Ray& ray) {
  const float size = max_abs(ray.direction);
  const float sum = fabsf(ray.origin.x) + fabsf(ray.origin.y) + fabsf(ray.origin.z) +
                    fabsf(ray.direction.x) + fabsf(ray.direction.y) + fabsf(ray.direction.z);
  return sum < HUGE_VALF && size > 0.0f;
}

/// A ray in an instance's own space, and the part of it in which the instance lies. Outside of its
/// box in the world an instance is not met, whatever rounding says inside: so which hits there are
/// depends on the ray, the instance and the triangle alone.
struct InstanceVisit {
  Ray ray;            ///< its direction keeps the new length, and so t its meaning
  SlabInterval part;  ///< hits are moved into it
  bool is_empty;

  /// How far boxes inside need a visit if hits up to `t_max` are of interest: what lies behind the
  /// part counts as lying at its end.
  PT_HD float limit(float t_max) const { return t_max >= part.far ? HUGE_VALF : t_max; }
  /// NaN stays NaN.
  PT_HD float moved(float t) const {
    return t < part.near ? part.near : t > part.far ? part.far : t;
  }
};

PT_HD Ray object_ray(const InstanceRecord& instance, const Ray& ray) {
  return {instance.to_object.point(ray.origin), instance.to_object.vector(ray.direction)};
}

/// Where the ray is in an instance's box; `world` is the ray, prepared.
PT_HD SlabInterval part_in_box(const InstanceRecord& instance, const SlabTestRay& world) {
  return intersect_slabs(world, instance.bounds.min, instance.bounds.max, -HUGE_VALF, HUGE_VALF);
}

PT_HD bool may_have_hit(const SlabInterval& part, float t_min, float t_max) {
  return part.is_hit() && part.near <= t_max && part.far > t_min;
}

PT_HD InstanceVisit visit_instance(const InstanceRecord& instance, const Ray& ray,
                                   const SlabTestRay& world, float t_min, float t_max) {
  const SlabInterval part = part_in_box(instance, world);
  InstanceVisit visit{object_ray(instance, ray), part, false};
  visit.is_empty = !may_have_hit(part, t_min, t_max) || !is_traceable(visit.ray);
  return visit;
}

/// The same as a query sees it; what moves is placed only if the ray meets its box.
template <class Query>
PT_HD InstanceVisit visit_instance_for(const Query& query, const InstanceRecord& instance,
                                       const Ray& ray, const SlabTestRay& world) {
  if constexpr (is_moving_query<Query>) {
    const SlabInterval part = part_in_box(instance, world);
    InstanceVisit visit{ray, part, !may_have_hit(part, query.t_min(), query.t_max())};
    if (visit.is_empty) return visit;
    visit.ray = object_ray(query.placed(instance), ray);
    visit.is_empty = !is_traceable(visit.ray);
    return visit;
  } else {
    return visit_instance(instance, ray, world, query.t_min(), query.t_max());
  }
}

/// Offers the triangles of `count` slots to the query; true: the traversal ends.
template <class Query>
PT_HD bool offer_slots(const TriangleTree& tree, const TriangleRay& ray, std::uint32_t first,
                       std::uint32_t count, Query& query) {
  PT_UNROLL(2)
  for (std::uint32_t slot = first; slot < first + count; ++slot) {
    const Triangle triangle = triangle_for(query, tree, slot);
    const TriangleHit hit = intersect_triangle(ray, triangle.v0, triangle.v1, triangle.v2);
    if constexpr (Query::has_masks) {
      if (query.hides(triangle, hit, hit.t, 0)) continue;
    }
    if (query.offer(tree, hit.t, slot, 0)) return true;
  }
  return false;
}

/// offer_slots() in an instance.
template <class Query>
PT_HD bool offer_slots(const TriangleTree& tree, const TriangleRay& ray, std::uint32_t first,
                       std::uint32_t count, const InstanceVisit& visit, std::uint32_t instance,
                       Query& query) {
  for (std::uint32_t slot = first; slot < first + count; ++slot) {
    const Triangle triangle = triangle_for(query, tree, slot);
    const TriangleHit hit = intersect_triangle(ray, triangle.v0, triangle.v1, triangle.v2);
    const float t = visit.moved(hit.t);
    if constexpr (Query::has_masks) {
      if (query.hides(triangle, hit, t, instance)) continue;
    }
    if (query.offer(tree, t, slot, instance)) return true;
  }
  return false;
}

}  // namespace pt
