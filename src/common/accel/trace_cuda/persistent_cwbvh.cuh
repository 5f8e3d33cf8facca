// Persistent warps on a compressed wide tree, for rays that have nothing in common.
//
// Rays differ in how many nodes they visit; a warp that waited for the slowest of 32 would be idle
// for most of its time. So a lane whose ray is done takes another one, as soon as `refill` lanes
// are idle. And the warp does one thing at a time, whatever more of its lanes wait for: steps down
// the tree or tests of leaves. A lane that has found leaves waits until they are tested: going on
// without knowing the hit would visit nodes behind it. The two triangles of a leaf are tested side
// by side. All votes are explicit and by the whole warp: since Volta, threads that part do not meet
// again by themselves.
#pragma once

#include "common/accel/ray_arrays.h"
#include "common/accel/trace_cuda/cwbvh_step.cuh"
#include "common/accel/trace_cuda/prepared_rays.cuh"
#include "common/accel/trace_cuda/slot_order.cuh"

namespace pt {

/// What a warp needs now and then, in shared memory: registers are short.
struct PersistentWarp {
  static constexpr std::uint32_t none = 0xffffffffu;

  PreparedRays rays;
  int next_ray, ray_count;   ///< of `rays`: those from next_ray on are not handed out
  std::uint32_t number[32];  ///< by lane: of the ray whose result is not written; none
  ReservedRays reserved;
};

/// What the threads of a block share.
template <int block_size>
struct PersistentMemory {
  SlotOrder order;
  PersistentWarp warps[block_size / 32];
};

/// Inner children that are left to visit: bits 0..7 their slots, 8..10 the ray's octant (so that
/// bits 0..10 are the place in SlotOrder), 16..23 the node's inner_mask.
struct SlotGroup {
  std::uint32_t base;
  std::uint32_t bits;

  __device__ bool has_slots() const { return (bits & 0xffu) != 0; }
};

struct PersistentTuning {
  static constexpr int refill = 8;  ///< idle lanes that make the warp hand out rays
  /// A warp steps if stepping lanes * step_weight >= testing lanes * test_weight.
  static constexpr int step_weight = 1, test_weight = 2;
};

/// Traces what `work` hands out, one lane's view. Query: one with offer_nearer. Work has
///   std::uint32_t fetch(unsigned lane, ReservedRays&, RayRecord&, int& count)  by the whole warp:
///     up to 32 rays with successive numbers, one each for the first `count` lanes; returns the
///     first's number; count 0: there is none left
///   void finish(std::uint32_t number, const Query&)  by lanes whose ray is done
///   bool hides(const Query&, std::uint32_t slot, const TriangleHit&)  where Query::has_masks: the
///     triangle's mask lets the ray through
///   LaneCounter lanes(std::uint32_t number)  if its rays' lanes are to be counted
template <class Query, class Work>
class PersistentTracer {
 public:
  __device__ PersistentTracer(const TriangleTree& tree, Work& work, const SlotOrder& order,
                              PersistentWarp& warp, uint2* stack)
      : tree_(tree), work_(work), order_(order), warp_(warp), stack_(stack) {}

  PT_LANE_COUNTER;  ///< of the lane's ray

  /// By the whole warp; returns when all rays are done.
  __device__ void run() {
    warp_.number[threadIdx.x & 31] = PersistentWarp::none;
    warp_.next_ray = warp_.ray_count = 0;
    warp_.reserved = {0, 0};
    __syncwarp();
    bool is_drained = false;  // no rays are left: only the end is waited for
    while (true) {
      const bool tests = leaves_.has_slots(), steps = !tests && nodes_.has_slots();
      const unsigned testing = __ballot_sync(whole_warp, tests);
      const unsigned stepping = __ballot_sync(whole_warp, steps);
      const int test_count = __popc(testing), step_count = __popc(stepping);
      if (test_count + step_count <= (is_drained ? 0 : 32 - PersistentTuning::refill)) {
        is_drained = !refill(~(testing | stepping));
        if (is_drained && (testing | stepping) == 0) return;
      } else if (PersistentTuning::step_weight * step_count >=
                 PersistentTuning::test_weight * test_count) {
        if (steps) step();
      } else if (tests) {
        test_leaf();
      }
    }
  }

 private:
  static constexpr unsigned whole_warp = 0xffffffffu;

  __device__ bool is_active() const { return nodes_.has_slots() || leaves_.has_slots(); }

  /// Finishes the rays of idle lanes and hands out others. False: there were none.
  __device__ bool refill(unsigned idle) {
    const unsigned lane = threadIdx.x & 31;
    if (!is_active() && warp_.number[lane] != PersistentWarp::none) {
      work_.finish(warp_.number[lane], query_);
      warp_.number[lane] = PersistentWarp::none;
    }
    int next = warp_.next_ray, count = warp_.ray_count;
    bool are_left = next < count;
    int place = (idle >> lane & 1u) != 0 ? next + __popc(idle & ((1u << lane) - 1)) : -1;
    next += __popc(idle);
    __syncwarp();
    while (true) {
      if (place >= 0 && place < count) begin(warp_.rays.load(static_cast<unsigned>(place)));
      if (next <= count) break;
      place -= count, next -= count;  // lanes that got none
      __syncwarp();
      count = fetch(lane);
      if (count == 0) break;
      are_left = true;
    }
    if (lane == 0) warp_.next_ray = next, warp_.ray_count = count;
    __syncwarp();
    return are_left;
  }

  /// Prepares up to 32 more rays.
  __device__ int fetch(unsigned lane) {
    RayRecord record;
    int count;
    const std::uint32_t first = work_.fetch(lane, warp_.reserved, record, count);
    if (static_cast<int>(lane) < count) warp_.rays.store(lane, record, first + lane);
    __syncwarp();
    return count;
  }

  __device__ void begin(const PreparedRay& ray) {
    origin_ = ray.origin;
    inverse_ = ray.inverse;
    triangle_ray_ = ray.triangles;
    query_ = Query(ray.t_min, ray.t_max);
    warp_.number[threadIdx.x & 31] = ray.number;
    if constexpr (counts_lanes && requires { work_.lanes(ray.number); }) {
      set_lanes(*this, work_.lanes(ray.number));
      lanes_of(*this).count(LanePoint::intersect);
    }
    const std::uint32_t octant = ray.octant << 8;
    nodes_ = {tree_.root, ray.t_max > 0.0f ? octant | 1u : 0u};  // the root as a child in slot 0
  }

  __device__ void step() {
    lanes_of(*this).count(LanePoint::node);
    const std::uint32_t octant = nodes_.bits & 0x700u;
    const std::uint32_t bit = 1u << order_.first[nodes_.bits & 0x7ffu];
    const std::uint32_t child = nodes_.base + __popc(nodes_.bits >> 16 & (bit - 1));
    nodes_.bits ^= bit;
    if (nodes_.has_slots()) stack_[depth_++] = {nodes_.base, nodes_.bits};
    const CwbvhWords node = load_cwbvh_words(&tree_.cwbvh[child]);
    const std::uint32_t hits = hit_slots(node, origin_, inverse_, query_.t_max());
    const std::uint32_t inner = node.inner_mask(), leaf = node.leaf_mask();
    nodes_ = {node.child_base(), (hits & inner) | octant | inner << 16};
    leaves_ = {node.triangle_base(), (hits & leaf) | leaf << 8 | node.pair_mask() << 16};
    if (!nodes_.has_slots() && depth_ > 0) {
      const uint2 top = stack_[--depth_];
      nodes_ = {top.x, top.y};
    }
  }

  /// A single triangle is tested as a pair with itself.
  __device__ void test_leaf() {
    lanes_of(*this).count(LanePoint::primitive);
    const CwbvhLeaf leaf = take_leaf(leaves_);
    const std::uint32_t last = leaf.first + leaf.count - 1;
    const Triangle a = load_wide(&tree_.triangles[leaf.first]);
    const Triangle b = load_wide(&tree_.triangles[last]);
    float t_a = intersect_triangle(triangle_ray_, a.v0, a.v1, a.v2).t;
    float t_b = intersect_triangle(triangle_ray_, b.v0, b.v1, b.v2).t;
    if constexpr (Query::has_masks) {
      const bool ask_a = is_up_to_mask(query_, a, t_a);
      const bool ask_b = leaf.count == 2 && is_up_to_mask(query_, b, t_b);
      drop_hidden(leaf, ask_a, ask_b, t_a, t_b);
    }
    if (query_.offer_nearer(tree_, {t_a, leaf.first, a.id}, {t_b, last, b.id})) {
      nodes_.bits = leaves_.bits = 0;
      depth_ = 0;
    }
  }

  /// What a mask hides was not met. One loop, so that lanes ask together, be it about their first
  /// triangle or their second.
  __device__ void drop_hidden(const CwbvhLeaf& leaf, bool ask_a, bool ask_b, float& t_a,
                              float& t_b) const {
    PT_UNROLL(1)
    while (ask_a || ask_b) {
      const bool hidden = is_hidden(leaf.first + (ask_a ? 0 : 1));
      if (hidden) (ask_a ? t_a : t_b) = bits_to_float(0x7fffffffu);
      if (!ask_a) ask_b = false;
      ask_a = false;
    }
    if (leaf.count == 1) t_b = t_a;
  }

  /// Meets the triangle again: to keep its coordinates would cost all tests registers, which spill.
  __device__ bool is_hidden(std::uint32_t slot) const {
    const Triangle triangle = load_wide(&tree_.triangles[slot]);
    return work_.hides(query_, slot,
                       intersect_triangle(triangle_ray_, triangle.v0, triangle.v1, triangle.v2));
  }

  const TriangleTree& tree_;
  Work& work_;
  const SlotOrder& order_;
  PersistentWarp& warp_;
  Query query_{0.0f, 0.0f};
  Vec3 origin_{}, inverse_{};
  TriangleRay triangle_ray_{};
  SlotGroup nodes_{0, 0};
  CwbvhGroup leaves_{0, 0};
  uint2* stack_;  ///< no member itself: an array would keep the members beside it out of registers
  int depth_ = 0;
};

/// Traces what `work` hands out until there is nothing left. All threads of the block call it.
template <class Query, int block_size, class Work>
__device__ void trace_persistent(const TriangleTree& tree, PersistentMemory<block_size>& memory,
                                 Work& work) {
  memory.order.fill();
  __syncthreads();
  uint2 stack[bvh_depth_max];
  PersistentTracer<Query, Work> tracer(tree, work, memory.order, memory.warps[threadIdx.x / 32],
                                       stack);
  tracer.run();
}

}  // namespace pt
