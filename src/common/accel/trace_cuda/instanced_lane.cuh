// One lane's way through a wide tree over instances and the wide trees in them, a step, a leaf or
// an instance at a time: the same hits as traverse_cwbvh (see 'Instances' in
// docs/design/tracing.md).
#pragma once

#include <type_traits>

#include "common/accel/trace_cuda/cwbvh_lane.cuh"
#include "common/accel/trace_cuda/prepared_rays.cuh"

namespace pt {

/// A query about what lies where at a time. Rays of paths begin at 0, so a ray's record has its
/// time where others have t_min.
template <class Query>
class TimedQuery : public Query {
 public:
  __device__ TimedQuery(float time, float t_max) : Query(0.0f, t_max), time_(time) {}
  __device__ TimedQuery(const Query& query, float time) : Query(query), time_(time) {}
  __device__ float time() const { return time_; }

 private:
  float time_;
};

/// A lane's traversal of two levels; see CwbvhLane. What is left to visit are groups of one form:
/// children in an instance, children in the world, instances. The instances of a node come before
/// its inner children, the nearer ones first.
template <class QueryType>
class InstancedLane {
 public:
  using Query = QueryType;
  using Rays = WorldRays;
  using Memory = InstancedLanes;
  static constexpr bool has_instances = true;
  static constexpr bool is_speculative = false;
  /// For both levels a group for each level of nodes; where an instance is entered, the instances
  /// beside it and the mark.
  static constexpr int stack_size = 2 * bvh_depth_max + 2;
  static_assert(!Query::has_masks);

  __device__ InstancedLane(const TriangleTree& tree, const SlotOrder& order, uint2* stack,
                           Memory& memory)
      : tree_(tree), order_(order), stack_(stack), memory_(memory) {}

  PT_LANE_COUNTER;  ///< of the lane's ray

  __device__ bool wants_test() const { return leaves_.has_slots(); }
  __device__ bool wants_enter() const { return !wants_test() && (nodes_.bits & instances) != 0; }
  /// Leaving an instance is the beginning of a step in the world.
  __device__ bool wants_step() const {
    return !wants_test() && (nodes_.bits & instances) == 0 && nodes_.has_slots();
  }
  __device__ bool is_active() const { return nodes_.has_slots() || leaves_.has_slots(); }

  /// With what was found so far.
  __device__ Query query() const {
    const std::uint32_t slot = memory_.slot[lane()];
    const bool has_hit = slot != no_primitive;
    Query query(begin_or_time(), has_hit ? infinite_distance : t_max_);
    if (has_hit) query.offer(tree_, t_max_, slot, memory_.hit_instance[lane()]);
    return query;
  }

  /// At the root.
  __device__ void begin(const WorldRay& ray, const Query& query) {
    const CwbvhRay world = make_cwbvh_ray({ray.origin, ray.direction});
    const Vec3 &o = ray.origin, &i = world.inverse, &d = ray.direction;
    memory_.origin[lane()] = {o.x, o.y, o.z, 0.0f};
    memory_.inverse[lane()] = {i.x, i.y, i.z, 0.0f};
    memory_.direction[lane()] = {d.x, d.y, d.z, begin_or_time_of(query)};
    memory_.slot[lane()] = no_primitive;
    origin_ = o, inverse_ = i;
    t_max_ = limit_ = query.t_max();
    set_kind(query);
    nodes_ = {tree_.root, ray.t_max > 0.0f ? in_world | world.octant << 8 | 1u : 0u};
  }

  /// See CwbvhLane. The ray and its hit stay in the lane's shared memory meanwhile.
  static constexpr int suspended_size = 3;
  __device__ void suspend(volatile uint2* state) const {
    state[0].x = nodes_.base;
    state[0].y = nodes_.bits;
    state[1].x = leaves_.base;
    state[1].y = leaves_.bits;
    state[2].x = static_cast<std::uint32_t>(depth_);
    state[2].y = __float_as_uint(t_max_);
  }
  template <class Work>
  __device__ void resume(const WorldRay&, const Query& query, const volatile uint2* state,
                         const Work& work) {
    nodes_ = {state[0].x, state[0].y};
    leaves_ = {state[1].x, state[1].y};
    depth_ = static_cast<int>(state[2].x);
    t_max_ = __uint_as_float(state[2].y);
    set_kind(query);
    if ((nodes_.bits & in_world) != 0) return set_world();
    const InstanceRecord instance = load_wide(&tree_.instances[memory_.instance[lane()]]);
    set_local(make_cwbvh_ray(object_ray(placed(work, instance), world_ray())));
    set_limit(memory_.inverse[lane()].w);
  }

  __device__ void step() {
    if ((nodes_.bits & mark) != 0) leave();
    if ((nodes_.bits & instances) != 0) return;
    lanes_of(*this).count(LanePoint::node);
    const bool inside = (nodes_.bits & in_world) == 0;
    const std::uint32_t child = take_first();
    if (nodes_.has_slots()) push(nodes_);
    const CwbvhWords node = load_cwbvh_words(&tree_.cwbvh[child]);
    const std::uint32_t misses =
        missed_slots(node, origin_, inverse_, select_near_planes(inverse_), limit_);
    const CwbvhGroup leaves = leaf_children(node, misses);
    nodes_ = inner_children(node, misses, nodes_);
    if (inside) {
      leaves_ = leaves;
    } else if (leaves.has_slots()) {
      const std::uint32_t bits = __byte_perm(leaves.bits, nodes_.bits, 0x1150) | instances;
      if (nodes_.has_slots()) push(nodes_);
      nodes_ = {leaves.base, bits};
    }
    go_on();
  }

  /// Goes to the root of the next instance, if the ray hits its box before the best hit.
  template <class Work>
  __device__ void enter(const Work& work) {
    const std::uint32_t instance_index = take_first();
    const InstanceRecord instance = load_wide(&tree_.instances[instance_index]);
    const Ray ray = world_ray();
    InstanceVisit visit;
    if constexpr (has_time) {
      visit.part = part_in_box(instance, make_slab_test_ray(ray));
      if (!may_have_hit(visit.part, t_min(), t_max_)) return go_on();
      // The ray is read again, and what steps need of it: they take no registers of the pose.
      visit.ray = object_ray(placed(work, instance), world_ray());
      if (!is_traceable(visit.ray)) {
        set_world();
        return go_on();
      }
    } else {
      visit = visit_instance(instance, ray, make_slab_test_ray(ray), t_min(), t_max_);
      if (visit.is_empty) return go_on();
    }
    if (nodes_.has_slots()) push(nodes_);
    if (depth_ > 0) push({0, mark | 1u});
    memory_.origin[lane()].w = visit.part.near;
    memory_.inverse[lane()].w = visit.part.far;
    memory_.instance[lane()] = instance_index;
    set_limit(visit.part.far);
    const CwbvhRay local = make_cwbvh_ray(visit.ray);
    set_local(local);
    nodes_ = {instance.root, local.octant << 8 | 1u};
  }

  template <class Work>
  __device__ void test_leaf(const Work&) {
    lanes_of(*this).count(LanePoint::primitive);
    const CwbvhLeaf leaf = take_leaf(leaves_);
    const std::uint32_t last = leaf.first + leaf.count - 1;
    const Triangle a = load_wide(&tree_.triangles[leaf.first]);
    const Triangle b = load_wide(&tree_.triangles[last]);
    TriangleRay ray = triangle_ray_;
    ray.origin = origin_;  // the same, and no further registers for what changes with it
    const float near = memory_.origin[lane()].w, far = memory_.inverse[lane()].w;
    const auto moved = [&](float t) { return t < near ? near : t > far ? far : t; };
    const float t_a = moved(intersect_triangle(ray, a.v0, a.v1, a.v2).t);
    const float t_b = moved(intersect_triangle(ray, b.v0, b.v1, b.v2).t);
    const float least = t_min();
    const bool nearer = t_b < t_a || (t_b == t_a && b.id < a.id);
    const bool second = !(t_a > least) || (t_b > least && nearer);
    const float t = second ? t_b : t_a;
    if (t > least && t <= t_max_) take(t, second ? last : leaf.first, far);
  }

 private:
  static constexpr bool finds_any = std::is_base_of_v<AnyTriangle, Query>;

  // Bits of a SlotGroup beside those that it has anyway:
  static constexpr std::uint32_t in_world = 1u << 11;   ///< children are in the tree over instances
  static constexpr std::uint32_t instances = 1u << 12;  ///< children are instances
  static constexpr std::uint32_t mark = 1u << 13;       ///< below it on the stack is the world

  static constexpr bool has_time = requires(const Query& query) { query.time(); };

  __device__ static unsigned lane() { return threadIdx.x & 31; }

  __device__ void push(const SlotGroup& group) { stack_[depth_++] = {group.base, group.bits}; }
  __device__ void pop() {
    nodes_.bits = 0;
    if (depth_ == 0) return;
    const uint2 top = stack_[--depth_];
    nodes_ = {top.x, top.y};
  }

  /// In what is left of the group, or in the one below.
  __device__ void go_on() {
    if (!nodes_.has_slots()) pop();
  }

  /// The index of the first child, which is taken out of the group.
  __device__ std::uint32_t take_first() {
    const std::uint32_t bit = order_.first[nodes_.bits & 0x7ffu];
    nodes_.bits ^= bit;
    return nodes_.base + __popc(nodes_.bits >> 16 & (bit - 1));
  }

  /// Below a mark there is always a group.
  __device__ void leave() {
    set_world();
    pop();
  }

  __device__ Ray world_ray() const {
    const float4 o = memory_.origin[lane()], d = memory_.direction[lane()];
    return {{o.x, o.y, o.z}, {d.x, d.y, d.z}};
  }

  __device__ void set_world() {
    const float4 o = memory_.origin[lane()], i = memory_.inverse[lane()];
    origin_ = {o.x, o.y, o.z}, inverse_ = {i.x, i.y, i.z};
    limit_ = t_max_;
  }

  __device__ void set_local(const CwbvhRay& ray) {
    origin_ = ray.origin, inverse_ = ray.inverse, triangle_ray_ = ray.triangles;
  }

  /// As InstanceVisit::limit.
  __device__ void set_limit(float far) { limit_ = t_max_ >= far ? HUGE_VALF : t_max_; }

  __device__ void set_kind([[maybe_unused]] const Query& query) {
    if constexpr (requires { query.is_shadow(); }) ends_with_hit_ = query.is_shadow();
  }

  __device__ float begin_or_time() const { return memory_.direction[lane()].w; }
  __device__ static float begin_or_time_of(const Query& query) {
    if constexpr (has_time) {
      return query.time();
    } else {
      return query.t_min();
    }
  }
  __device__ float t_min() const { return has_time ? 0.0f : begin_or_time(); }

  template <class Work>
  __device__ InstanceRecord placed([[maybe_unused]] const Work& work,
                                   const InstanceRecord& instance) const {
    if constexpr (has_time) {
      return work.placed(instance, begin_or_time());
    } else {
      return instance;
    }
  }

  /// Offers what was met at `t`, no farther than the best hit; of which memory has all but t.
  __device__ void take(float t, std::uint32_t slot, float far) {
    if (t == t_max_ && !wins_tie(slot)) return;
    t_max_ = t;
    set_limit(far);
    memory_.slot[lane()] = slot;
    memory_.hit_instance[lane()] = memory_.instance[lane()];
    if (ends_with_hit_) nodes_.bits = leaves_.bits = 0, depth_ = 0;
  }

  __device__ bool wins_tie(std::uint32_t slot) const {
    if constexpr (finds_any) {
      return false;
    } else {
      const std::uint32_t instance = memory_.instance[lane()];
      Query query = this->query();
      query.offer(tree_, t_max_, slot, instance);
      const Hit hit = query.result();
      return hit.primitive == slot && hit.instance == instance;
    }
  }

  const TriangleTree& tree_;
  const SlotOrder& order_;
  Vec3 origin_{}, inverse_{};
  TriangleRay triangle_ray_{};
  SlotGroup nodes_{0, 0};
  CwbvhGroup leaves_{0, 0};
  uint2* stack_;
  Memory& memory_;
  int depth_ = 0;
  float t_max_ = 0.0f;  ///< of the query
  float limit_ = 0.0f;  ///< how far boxes need a visit
  bool ends_with_hit_ = finds_any;
};

}  // namespace pt
