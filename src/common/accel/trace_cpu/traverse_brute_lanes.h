// Every primitive against as many rays of a block as there are lanes: a lane is a ray, and executes
// the operations of the plain tests (traverse_brute.h) in their order and without contraction. L is
// Lanes8 or another type with its functions.
#pragma once

#include "common/accel/trace_cpu/lanes.h"
#include "common/accel/trace_cpu/ray_block.h"

#ifdef __x86_64__

namespace pt {

template <class L>
struct LaneVec {
  typename L::Float x, y, z;
};

template <class L>
PT_LANES inline LaneVec<L> load_lanes(const float (&v)[3][RayBlock::size_max],
                                      std::uint32_t first) {
  return {L::load(v[0] + first), L::load(v[1] + first), L::load(v[2] + first)};
}

/// v - p.
template <class L>
PT_LANES inline LaneVec<L> from_lanes(const Vec3& v, const LaneVec<L>& p) {
  return {L::all(v.x) - p.x, L::all(v.y) - p.y, L::all(v.z) - p.z};
}

/// As dot_from_x.
template <class L>
PT_LANES inline typename L::Float dot_lanes(const LaneVec<L>& a, const LaneVec<L>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class L>
PT_LANES inline typename L::Float dot_lanes(const Vec3& a, const LaneVec<L>& b) {
  return L::all(a.x) * b.x + L::all(a.y) * b.y + L::all(a.z) * b.z;
}

/// Rays and the nearest hits that they have had.
template <class L>
struct LaneRays {
  LaneVec<L> origin, direction;
  typename L::Float t;  ///< of that hit, or t_max
  typename L::Int primitive;

  PT_LANES LaneRays(const RayBlock& rays, std::uint32_t first)
      : origin(load_lanes<L>(rays.origin, first)),
        direction(load_lanes<L>(rays.direction, first)),
        t(L::load(rays.t_max + first)),
        primitive(L::all_int(no_primitive)) {}

  PT_LANES void store(HitBlock& hits, std::uint32_t first) const {
    L::store(hits.t + first, t);
    L::store(hits.primitive + first, primitive);
  }
};

/// As keep_nearer, where primitives come by ascending number.
template <class L>
PT_LANES inline void keep_nearer_lanes(LaneRays<L>& rays, typename L::Mask met, typename L::Float t,
                                       std::uint32_t primitive) {
  const typename L::Int index = L::all_int(primitive);
  const typename L::Mask ties = L::both(L::equal(t, rays.t), L::less_int(index, rays.primitive));
  const typename L::Mask nearer =
      L::both(L::both(met, L::less(L::all(0.0f), t)), L::either(L::less(t, rays.t), ties));
  rays.t = L::select(nearer, t, rays.t);
  rays.primitive = L::select(nearer, index, rays.primitive);
}

/// As ProjectedRay.
template <class L>
struct LaneProjection {
  LaneVec<L> x_axis, y_axis;
  typename L::Float x, y;

  PT_LANES LaneProjection(const LaneRays<L>& rays, const Vec3& center) {
    using Float = typename L::Float;
    const LaneVec<L>& n = rays.direction;  // make_frame
    const Float one = L::all(1.0f), sign = L::sign(n.z), minus = L::negative(sign);
    const Float a = L::negative(one / (sign + n.z));
    const Float b = n.x * n.y * a;
    x_axis = {sign * n.x * n.x * a + one, sign * b, minus * n.x};
    y_axis = {b, n.y * n.y * a + sign, L::negative(n.y)};
    const LaneVec<L>& o = rays.origin;
    const LaneVec<L> origin = {o.x - L::all(center.x), o.y - L::all(center.y),
                               o.z - L::all(center.z)};
    x = dot_lanes<L>(x_axis, origin);
    y = dot_lanes<L>(y_axis, origin);
  }

  PT_LANES typename L::Float nearness(const Sphere& sphere) const {
    using Float = typename L::Float;
    const Float cx = L::all(sphere.center.x), cy = L::all(sphere.center.y),
                cz = L::all(sphere.center.z);
    const Float px = cx * x_axis.x + (cy * x_axis.y + (cz * x_axis.z - x));
    const Float py = cx * y_axis.x + (cy * y_axis.y + (cz * y_axis.z - y));
    return L::all(sphere.radius_squared) - px * px - py * py;
  }
};

/// As sphere_distance.
template <class L>
PT_LANES inline typename L::Float sphere_distances(const Sphere& sphere, const LaneRays<L>& rays) {
  using Float = typename L::Float;
  const Float zero = L::all(0.0f);
  const LaneVec<L>& d = rays.direction;
  const LaneVec<L> oc = from_lanes<L>(sphere.center, rays.origin);
  const Float b = dot_lanes<L>(oc, d);
  const LaneVec<L> off = {oc.x - b * d.x, oc.y - b * d.y, oc.z - b * d.z};
  const Float discriminant =
      L::all(sphere.radius_squared) - off.x * off.x - off.y * off.y - off.z * off.z;
  const Float half_chord =
      L::select(L::less(zero, discriminant), L::square_root(discriminant), zero);
  const Float near = b - half_chord;
  const Float t = L::select(L::less(zero, near), near, b + half_chord);
  return L::select(L::less(discriminant, zero), L::all(-1.0f), t);
}

/// As quad_distance.
template <class L>
PT_LANES inline typename L::Float quad_distances(const Quad& quad, const LaneRays<L>& rays) {
  using Float = typename L::Float;
  const LaneVec<L>& d = rays.direction;
  const Float cosine = dot_lanes<L>(quad.normal, d);
  const LaneVec<L> oc = from_lanes<L>(quad.corner, rays.origin);
  const Float t = dot_lanes<L>(quad.normal, oc) / cosine;
  const LaneVec<L> p = {t * d.x - oc.x, t * d.y - oc.y, t * d.z - oc.z};
  const Float a = dot_lanes<L>(quad.dual_a, p), b = dot_lanes<L>(quad.dual_b, p);
  const Float low = L::all(-quad_margin), high = L::all(1.0f + quad_margin);
  const typename L::Mask inside =
      L::both(L::both(L::both(L::less_equal(low, a), L::less_equal(a, high)),
                      L::both(L::less_equal(low, b), L::less_equal(b, high))),
              L::less(t, L::all(infinite_distance)));
  return L::select(inside, t, L::all(-1.0f));
}

/// Offers every sphere and quad that a lane may meet: `visit(mask, t, primitive)` of Visitor, until
/// that returns true.
template <class L, class Visitor>
PT_LANES inline void visit_primitives(const Primitives& primitives, LaneRays<L>& rays,
                                      Visitor& visitor) {
  const LaneProjection<L> projected(rays, primitives.scan_center);
  for (std::uint32_t i = 0; i < primitives.sphere_count; ++i) {
    const typename L::Float nearness = projected.nearness(primitives.scan[i]);
    if (L::bits_without_sign(nearness) == 0) continue;
    const typename L::Mask candidates = L::without_sign(nearness);
    if (visitor.visit(rays, candidates, sphere_distances<L>(primitives.spheres[i], rays), i))
      return;
  }
  const typename L::Mask all = L::every_lane();
  for (std::uint32_t i = 0; i < primitives.quad_count; ++i) {
    const typename L::Float t = quad_distances<L>(primitives.quads[i], rays);
    if (visitor.visit(rays, all, t, primitives.sphere_count + i)) return;
  }
}

template <class L>
struct ClosestLanes {
  PT_LANES bool visit(LaneRays<L>& rays, typename L::Mask met, typename L::Float t,
                      std::uint32_t primitive) {
    keep_nearer_lanes<L>(rays, met, t, primitive);
    return false;
  }
};

/// Lanes that have met anything; all have, or the others meet nothing: then it ends.
template <class L>
struct AnyLanes {
  typename L::Mask found, hopeless;

  PT_LANES explicit AnyLanes(const LaneRays<L>& rays)
      : found(L::no_lane()), hopeless(L::less_equal(rays.t, L::all(0.0f))) {}

  PT_LANES bool visit(const LaneRays<L>& rays, typename L::Mask met, typename L::Float t,
                      std::uint32_t /*primitive*/) {
    const typename L::Mask in_range = L::both(L::less(L::all(0.0f), t), L::less(t, rays.t));
    found = L::either(found, L::both(met, in_range));
    return L::bits(L::either(found, hopeless)) == L::every_bit;
  }
};

template <class L>
PT_LANES inline void closest_primitives_lanes(const Primitives& primitives, const RayBlock& rays,
                                              HitBlock& hits) {
  for (std::uint32_t first = 0; first < rays.count; first += L::count) {
    LaneRays<L> lanes(rays, first);
    ClosestLanes<L> closest;
    visit_primitives<L>(primitives, lanes, closest);
    lanes.store(hits, first);
  }
}

template <class L>
PT_LANES inline std::uint32_t any_primitives_lanes(const Primitives& primitives,
                                                   const RayBlock& rays) {
  std::uint32_t found = 0;
  for (std::uint32_t first = 0; first < rays.count; first += L::count) {
    LaneRays<L> lanes(rays, first);
    AnyLanes<L> any(lanes);
    visit_primitives<L>(primitives, lanes, any);
    found |= L::bits(any.found) << first;
  }
  return found;
}

/// As make_triangle_ray; what is_traceable sorts out meets nothing.
template <class L>
struct LaneTriangleRays {
  using Float = typename L::Float;
  using Mask = typename L::Mask;
  LaneVec<L> x_axis, y_axis;
  Float inverse;
  Mask is_z, is_y;  ///< the axis along which depth is measured; else x

  PT_LANES explicit LaneTriangleRays(const LaneRays<L>& rays) {
    const LaneVec<L>& d = rays.direction;
    const Float zero = L::all(0.0f), one = L::all(1.0f);
    const LaneVec<L> size = {L::absolute(d.x), L::absolute(d.y), L::absolute(d.z)};
    is_z = L::both(L::less_equal(size.x, size.z), L::less_equal(size.y, size.z));
    is_y = L::but_not(L::less_equal(size.x, size.y), is_z);
    inverse = one / L::select(is_z, d.z, L::select(is_y, d.y, d.x));
    const Float x = L::negative(d.x) * inverse, y = L::negative(d.y) * inverse,
                z = L::negative(d.z) * inverse;
    x_axis = {pick(one, zero, y), pick(zero, z, one), pick(x, one, zero)};
    y_axis = {pick(zero, one, z), pick(one, x, zero), pick(y, zero, one)};
  }

  PT_LANES Float pick(Float z, Float y, Float x) const {
    return L::select(is_z, z, L::select(is_y, y, x));
  }
};

template <class L>
PT_LANES inline typename L::Mask traceable_lanes(const LaneRays<L>& rays) {
  const LaneVec<L>&o = rays.origin, &d = rays.direction;
  const typename L::Float x = L::absolute(d.x), y = L::absolute(d.y), z = L::absolute(d.z);
  const typename L::Float sum = L::absolute(o.x) + L::absolute(o.y) + L::absolute(o.z) + x + y + z;
  return L::both(L::less(sum, L::all(HUGE_VALF)), L::less(L::all(0.0f), L::most(L::most(x, y), z)));
}

/// Which rays meet the triangle at t, 0 < t <= t_max: intersect_triangle.
template <class L>
PT_LANES inline typename L::Mask meet_triangle(const LaneRays<L>& rays,
                                               const LaneTriangleRays<L>& axes,
                                               const Triangle& triangle, typename L::Float t_max,
                                               typename L::Float& t) {
  using Float = typename L::Float;
  const LaneVec<L> p[3] = {from_lanes<L>(triangle.v0, rays.origin),
                           from_lanes<L>(triangle.v1, rays.origin),
                           from_lanes<L>(triangle.v2, rays.origin)};
  Float x[3], y[3], depth[3];
  PT_UNROLL(3)
  for (int i = 0; i < 3; ++i) {
    x[i] = axes.x_axis.x * p[i].x + (axes.x_axis.y * p[i].y + axes.x_axis.z * p[i].z);
    y[i] = axes.y_axis.x * p[i].x + (axes.y_axis.y * p[i].y + axes.y_axis.z * p[i].z);
    depth[i] = axes.pick(p[i].z, p[i].y, p[i].x);
  }
  return meet_projected<L>(x, y, depth, axes.inverse, L::all(0.0f), t_max, t);
}

template <class L>
PT_LANES inline void closest_triangles_lanes(const TriangleTree& tree, const RayBlock& rays,
                                             HitBlock& hits) {
  for (std::uint32_t first = 0; first < rays.count; first += L::count) {
    LaneRays<L> lanes(rays, first);
    lanes.t = L::select(traceable_lanes<L>(lanes), lanes.t, L::all(-1.0f));
    const LaneTriangleRays<L> axes(lanes);
    typename L::Int id = L::all_int(0);  // of the nearest; none is less while nothing is met
    for (std::uint32_t slot = 0; slot < tree.triangle_count; ++slot) {
      const Triangle& triangle = tree.triangles[slot];
      typename L::Float t;
      const typename L::Mask met = meet_triangle<L>(lanes, axes, triangle, lanes.t, t);
      if (L::bits(met) == 0) continue;
      // As ClosestTriangle::offer.
      const typename L::Int triangle_id = L::all_int(triangle.id);
      const typename L::Mask taken =
          L::both(met, L::either(L::less(t, lanes.t), L::less_int(triangle_id, id)));
      lanes.t = L::select(taken, t, lanes.t);
      lanes.primitive = L::select(taken, L::all_int(slot), lanes.primitive);
      id = L::select(taken, triangle_id, id);
    }
    lanes.store(hits, first);
  }
}

template <class L>
PT_LANES inline std::uint32_t any_triangles_lanes(const TriangleTree& tree, const RayBlock& rays) {
  std::uint32_t found = 0;
  for (std::uint32_t first = 0; first < rays.count; first += L::count) {
    LaneRays<L> lanes(rays, first);
    lanes.t = L::select(traceable_lanes<L>(lanes), lanes.t, L::all(-1.0f));
    const LaneTriangleRays<L> axes(lanes);
    AnyLanes<L> any(lanes);
    for (std::uint32_t slot = 0; slot < tree.triangle_count; ++slot) {
      typename L::Float t;
      const typename L::Mask met = meet_triangle<L>(lanes, axes, tree.triangles[slot], lanes.t, t);
      if (L::bits(met) != 0 && any.visit(lanes, met, t, slot)) break;
    }
    found |= L::bits(any.found) << first;
  }
  return found;
}

template <class L>
inline constexpr BruteBlock brute_block_by = {closest_primitives_lanes<L>, any_primitives_lanes<L>,
                                              closest_triangles_lanes<L>, any_triangles_lanes<L>};

}  // namespace pt

#endif
