// One lane's traversal of a compressed wide tree, a step or a leaf at a time, so that a warp can
// vote on what its lanes do together.
#pragma once

#include "common/accel/trace_cuda/choose_next.cuh"
#include "common/accel/trace_cuda/cwbvh_step.cuh"
#include "common/accel/trace_cuda/prepared_rays.cuh"

namespace pt {

/// Inner children that are left to visit: bits 0..7 their slots, 8..10 the ray's octant (so that
/// bits 0..10 are the index into SlotOrder), 16..23 the node's inner_mask; 24..31 are anything.
struct SlotGroup {
  std::uint32_t base;
  std::uint32_t bits;

  __device__ bool has_slots() const { return (bits & 0xffu) != 0; }
};

/// The inner children of a node that are not missed; `parent` has the ray's octant.
__device__ inline SlotGroup inner_children(const CwbvhWords& node, std::uint32_t misses,
                                           const SlotGroup& parent) {
  return {node.child_base(), __byte_perm(node.part[0].w, parent.bits, 0x0050) & ~misses};
}

/// As leaf_group, but for the highest bits.
__device__ inline CwbvhGroup leaf_children(const CwbvhWords& node, std::uint32_t misses) {
  return {node.triangle_base(), __byte_perm(node.part[1].x, node.part[1].y, 0x0400) & ~misses};
}

/// A lane's traversal, which can be suspended between any two steps and resumed later. Query: one
/// with offer_nearer. The two triangles of a leaf are tested side by side.
///
/// A lane that has found leaves tests them before it visits further nodes, which a hit could cull.
/// A speculative one continues all the same until it has found leaves of a second node, and can
/// take part in whatever more of its warp's lanes want (Aila and Laine 2009, "Understanding the
/// Efficiency of Ray Traversal on GPUs"); it begins at the root's children
/// (PreparedRays::meet_root). That pays where there are 72 registers.
template <class QueryType, bool speculative = false>
class CwbvhLane {
 public:
  using Query = QueryType;
  using Rays = PreparedRays;
  struct Memory {};  ///< nothing in shared memory
  static constexpr bool has_instances = false;
  static constexpr bool is_speculative = speculative;
  static constexpr int stack_size = bvh_depth_max;

  __device__ CwbvhLane(const TriangleTree& tree, const SlotOrder& order, uint2* stack,
                       const Memory& = {})
      : tree_(tree), order_(order), stack_(stack) {}

  PT_LANE_COUNTER;  ///< of the lane's ray

  __device__ bool wants_test() const { return leaves_.has_slots(); }
  __device__ bool wants_step() const {
    return nodes_.has_slots() && !(speculative ? later_leaves_ : leaves_).has_slots();
  }
  __device__ bool is_active() const { return nodes_.has_slots() || leaves_.has_slots(); }
  __device__ const Query& query() const { return query_; }

  /// At the root, or at its children.
  __device__ void begin(const PreparedRay& ray, const Query& query) {
    set_ray(ray);
    query_ = query;
    const std::uint32_t octant = ray.octant << 8;
    if constexpr (speculative) {
      const CwbvhWords root = load_cwbvh_masks(&tree_.cwbvh[tree_.root]);
      nodes_ = inner_children(root, ray.root_misses, {0, octant});
      leaves_ = leaf_children(root, ray.root_misses);
    } else {
      nodes_ = {tree_.root, ray.t_max > 0.0f ? octant | 1u : 0u};  // the root as a child in slot 0
    }
  }

  /// The size of the state that suspend() stores.
  static constexpr int suspended_size = speculative ? 5 : 4;

  /// Stores the state of the traversal, so that code between two steps can use its registers.
  /// Volatile: otherwise the compiler would keep the values in registers all the same, or store
  /// them whenever a step changes them.
  __device__ void suspend(volatile uint2* state) const {
    volatile uint2& met = state[suspended_size - 1];
    met.x = __float_as_uint(query_.t_max());
    met.y = query_.result().primitive;
    state[0].x = nodes_.base;
    state[0].y = nodes_.bits;
    state[1].x = leaves_.base;
    state[1].y = leaves_.bits;
    state[2].x = static_cast<std::uint32_t>(depth_);
    if constexpr (speculative) {
      state[3].x = later_leaves_.base;
      state[3].y = later_leaves_.bits;
    }
  }
  /// `ray` and `query` as for begin().
  template <class Work>
  __device__ void resume(const PreparedRay& ray, const Query& query, const volatile uint2* state,
                         const Work&) {
    set_ray(ray);
    const volatile uint2& met = state[suspended_size - 1];
    query_ = query.resumed(tree_, __uint_as_float(met.x), met.y);
    nodes_ = {state[0].x, state[0].y};
    leaves_ = {state[1].x, state[1].y};
    depth_ = static_cast<int>(state[2].x);
    if constexpr (speculative) later_leaves_ = {state[3].x, state[3].y};
  }

  __device__ void step() {
    lanes_of(*this).count(LanePoint::node);
    const std::uint32_t bit = order_.first[nodes_.bits & 0x7ffu];
    const std::uint32_t child = nodes_.base + __popc(nodes_.bits >> 16 & (bit - 1));
    nodes_.bits ^= bit;
    const CwbvhWords node = load_cwbvh_words(&tree_.cwbvh[child]);
    const std::uint32_t misses = missed_slots(node, origin_, inverse_, planes(), query_.t_max());
    (speculative && leaves_.has_slots() ? later_leaves_ : leaves_) = leaf_children(node, misses);
    const SlotGroup inner = inner_children(node, misses, nodes_);
    const bool goes_down = inner.has_slots(), has_rest = nodes_.has_slots();
    if (goes_down && has_rest) stack_[depth_++] = {nodes_.base, nodes_.bits};
    nodes_ = {goes_down ? inner.base : nodes_.base, goes_down ? inner.bits : nodes_.bits};
    if (!goes_down && !has_rest && depth_ > 0) {
      const uint2 top = stack_[--depth_];
      nodes_ = {top.x, top.y};
    }
  }

  /// A single triangle is tested as a pair with itself. Where Query::has_masks, `work` tells what
  /// they let through: bool hides(const Query&, std::uint32_t slot, const TriangleHit&).
  template <class Work>
  __device__ void test_leaf(const Work& work) {
    lanes_of(*this).count(LanePoint::primitive);
    const CwbvhLeaf leaf = take_leaf(leaves_);
    if constexpr (speculative) {
      if (!leaves_.has_slots()) leaves_ = later_leaves_, later_leaves_.bits = 0;
    }
    const std::uint32_t last = leaf.first + leaf.count - 1;
    const Triangle a = load_wide(&tree_.triangles[leaf.first]);
    const Triangle b = load_wide(&tree_.triangles[last]);
    float t_a = intersect_triangle(triangle_ray_, a.v0, a.v1, a.v2).t;
    float t_b = intersect_triangle(triangle_ray_, b.v0, b.v1, b.v2).t;
    if constexpr (Query::has_masks) {
      const bool ask_a = is_up_to_mask(query_, a, t_a);
      const bool ask_b = leaf.count == 2 && is_up_to_mask(query_, b, t_b);
      drop_hidden(work, leaf, ask_a, ask_b, t_a, t_b);
    }
    if (query_.offer_nearer(tree_, {t_a, leaf.first, a.id}, {t_b, last, b.id})) {
      nodes_.bits = leaves_.bits = later_leaves_.bits = 0;
      depth_ = 0;
    }
  }

 private:
  __device__ void set_ray(const PreparedRay& ray) {
    origin_ = ray.origin;
    inverse_ = ray.inverse;
    planes_ = select_near_planes(ray.inverse);
    triangle_ray_ = ray.triangles;
  }

  /// Kept where there are registers for them.
  __device__ NearPlanes planes() const {
    if constexpr (Query::has_masks) {
      return select_near_planes(inverse_);
    } else {
      return planes_;
    }
  }

  /// Drops hits that a mask hides. One loop, so that lanes evaluate masks together, be it about
  /// their first triangle or their second.
  template <class Work>
  __device__ void drop_hidden(const Work& work, const CwbvhLeaf& leaf, bool ask_a, bool ask_b,
                              float& t_a, float& t_b) const {
    PT_UNROLL(1)
    while (ask_a || ask_b) {
      const bool hidden = is_hidden(work, leaf.first + (ask_a ? 0 : 1));
      if (hidden) (ask_a ? t_a : t_b) = bits_to_float(0x7fffffffu);
      if (!ask_a) ask_b = false;
      ask_a = false;
    }
    if (leaf.count == 1) t_b = t_a;
  }

  /// Meets the triangle again: to keep its coordinates would cost all tests registers, which spill.
  template <class Work>
  __device__ bool is_hidden(const Work& work, std::uint32_t slot) const {
    const Triangle triangle = load_wide(&tree_.triangles[slot]);
    return work.hides(query_, slot,
                      intersect_triangle(triangle_ray_, triangle.v0, triangle.v1, triangle.v2));
  }

  const TriangleTree& tree_;
  const SlotOrder& order_;
  Query query_{0.0f, 0.0f};
  Vec3 origin_{}, inverse_{};
  NearPlanes planes_{};
  TriangleRay triangle_ray_{};
  SlotGroup nodes_{0, 0};
  CwbvhGroup leaves_{0, 0}, later_leaves_{0, 0};  ///< the latter only if there are the former
  uint2* stack_;  ///< no member itself: an array would keep the members beside it out of registers
  int depth_ = 0;
};

}  // namespace pt
