// Persistent warps on a compressed wide tree, for rays that have nothing in common.
//
// Rays differ in how many nodes they visit; a warp that waited for the slowest of 32 would be idle
// for most of its time. So a lane whose ray is done takes another one, as soon as `refill` lanes
// are idle. And the warp does one thing at a time: steps down the tree while at least
// `nodes_least` lanes have one to do, then triangles while at least `triangles_least` lanes have
// some. A lane that has found triangles waits until they are tested: going on without knowing the
// hit would visit nodes behind it. All votes are explicit and by the whole warp: since Volta,
// threads that part do not meet again by themselves.
#pragma once

#include "common/trace/cwbvh_step.cuh"
#include "common/trace/prepared_rays.cuh"
#include "common/trace/ray_arrays.h"
#include "common/trace/slot_order.cuh"

namespace pt {

/// What a warp needs now and then, in shared memory: registers are short.
struct PersistentWarp {
  static constexpr std::uint32_t none = 0xffffffffu;

  PreparedRays rays;
  int next_ray, ray_count;   ///< of `rays`: those from next_ray on are not handed out
  int refill;                ///< idle lanes that make the warp hand out rays
  std::uint32_t number[32];  ///< by lane: of the ray whose result is not written; none
  ReservedRays reserved;
};

/// What the threads of a block share.
template <int block_size>
struct PersistentMemory {
  SlotOrder order;
  PersistentWarp warps[block_size / 32];
};

/// What is left of a node: bits 0..7 slots of inner children to visit, bits 8..15 its inner_mask.
struct SlotGroup {
  std::uint32_t base;
  std::uint32_t bits;

  __device__ bool has_slots() const { return (bits & 0xffu) != 0; }
};

struct PersistentTuning {
  static constexpr int refill = 6;
  static constexpr int nodes_least = 16;
};

/// Traces what `work` hands out, one lane's view. Query: ClosestTriangle or AnyTriangle. Work has
///   std::uint32_t fetch(unsigned lane, ReservedRays&, RayRecord&, int& count)  by the whole warp:
///     up to 32 rays with successive numbers, one each for the first `count` lanes; returns the
///     first's number; count 0: there is none left
///   void finish(std::uint32_t number, const Query&)  by lanes whose ray is done
template <class Query, int triangles_least, class Work>
class PersistentTracer {
 public:
  __device__ PersistentTracer(const TriangleTree& tree, Work& work, const SlotOrder& order,
                              PersistentWarp& warp, uint2* stack)
      : tree_(tree), work_(work), order_(order), warp_(warp), stack_(stack) {}

  /// By the whole warp; returns when all rays are done.
  __device__ void run() {
    warp_.number[threadIdx.x & 31] = PersistentWarp::none;
    warp_.next_ray = warp_.ray_count = 0;
    warp_.refill = PersistentTuning::refill;
    warp_.reserved = {0, 0};
    __syncwarp();
    while (true) {
      const unsigned idle = __ballot_sync(whole_warp, !is_active());
      if (__popc(idle) >= warp_.refill) {
        refill(idle);
        if (idle == whole_warp && warp_.refill == 32) return;
      }
      step_down();
      gather_triangles();
      test_triangles();
    }
  }

 private:
  static constexpr unsigned whole_warp = 0xffffffffu;

  __device__ bool is_active() const { return nodes_.has_slots() || triangles_ != 0; }

  __device__ void refill(unsigned idle) {
    const unsigned lane = threadIdx.x & 31;
    if (!is_active() && warp_.number[lane] != PersistentWarp::none) {
      work_.finish(warp_.number[lane], query_);
      warp_.number[lane] = PersistentWarp::none;
    }
    int next = warp_.next_ray, count = warp_.ray_count;
    __syncwarp();
    if (next >= count) {
      RayRecord record;
      const std::uint32_t first = work_.fetch(lane, warp_.reserved, record, count);
      next = 0;
      if (count == 0) warp_.refill = 32;  // there is none left: only the end is waited for
      if (static_cast<int>(lane) < count) warp_.rays.store(lane, record, first + lane);
      warp_.ray_count = count;
    }
    warp_.next_ray = next + __popc(idle);
    __syncwarp();
    const int place = next + __popc(idle & ((1u << lane) - 1));
    if (!is_active() && place < count) begin(warp_.rays.load(static_cast<unsigned>(place)));
  }

  __device__ void begin(const PreparedRay& ray) {
    origin_ = ray.origin;
    inverse_ = ray.inverse;
    triangle_ray_ = ray.triangles;
    query_ = Query(ray.t_min, ray.t_max);
    warp_.number[threadIdx.x & 31] = ray.number;
    slot_order_ = order_.first[ray.octant];
    nodes_ = {tree_.root, ray.t_max > 0.0f ? 1u : 0u};  // the root as the only child, in slot 0
  }

  /// Steps until too few lanes have one to do; at least one, if any lane has.
  __device__ void step_down() {
    for (bool is_first = true;; is_first = false) {
      const bool steps = nodes_.has_slots() && leaf_slots_ == 0 && triangles_ == 0;
      const unsigned stepping = __ballot_sync(whole_warp, steps);
      if (stepping == 0) return;
      if (!is_first && __popc(stepping) < PersistentTuning::nodes_least) return;
      if (steps) step();
    }
  }

  __device__ void step() {
    const std::uint32_t slot = slot_order_[nodes_.bits & 0xffu];
    const std::uint32_t bit = 1u << slot;
    const std::uint32_t child = nodes_.base + __popc(nodes_.bits >> 8 & (bit - 1));
    nodes_.bits ^= bit;
    if (nodes_.has_slots()) stack_[depth_++] = {nodes_.base, nodes_.bits};
    const CwbvhWords node = load_cwbvh_words(&tree_.cwbvh[child]);
    const std::uint32_t hits = hit_slots(node, origin_, inverse_, query_.t_max());
    const std::uint32_t inner = node.inner_mask();
    nodes_ = {node.child_base(), (hits & inner) | inner << 8};
    leaf_slots_ = hits & ~inner;
    triangle_base_ = node.triangle_base();
    meta_ = node.meta();
    if (!nodes_.has_slots() && depth_ > 0) {
      const uint2 top = stack_[--depth_];
      nodes_ = {top.x, top.y};
    }
  }

  /// From slots of leaves to triangles: bit i is the one in slot triangle_base_ + i.
  __device__ void gather_triangles() {
    while (leaf_slots_ != 0) {
      const int slot = __ffs(static_cast<int>(leaf_slots_)) - 1;
      leaf_slots_ &= leaf_slots_ - 1;
      const std::uint32_t meta = __byte_perm(meta_.x, meta_.y, slot) & 0xffu;
      triangles_ |= (meta >> 5) << (meta & 31u);
    }
  }

  __device__ void test_triangles() {
    while (true) {
      const unsigned testing = __ballot_sync(whole_warp, triangles_ != 0);
      if (testing == 0) return;
      if (triangles_ != 0) test_triangle();
      if (__popc(testing) < triangles_least) return;
    }
  }

  __device__ void test_triangle() {
    const int bit = __ffs(static_cast<int>(triangles_)) - 1;
    triangles_ &= triangles_ - 1;
    const std::uint32_t slot = triangle_base_ + static_cast<std::uint32_t>(bit);
    const Triangle triangle = load_wide(&tree_.triangles[slot]);
    const TriangleHit hit =
        intersect_triangle(triangle_ray_, triangle.v0, triangle.v1, triangle.v2);
    if (query_.offer(tree_, hit.t, slot, 0)) {
      nodes_.bits = triangles_ = 0;
      depth_ = 0;
    }
  }

  const TriangleTree& tree_;
  Work& work_;
  const SlotOrder& order_;
  PersistentWarp& warp_;
  Query query_{0.0f, 0.0f};
  Vec3 origin_{}, inverse_{};
  TriangleRay triangle_ray_{};
  const std::uint8_t* slot_order_ = nullptr;
  SlotGroup nodes_{0, 0};
  std::uint32_t leaf_slots_ = 0, triangle_base_ = 0, triangles_ = 0;
  uint2 meta_{0, 0};
  uint2* stack_;  ///< no member itself: an array would keep the members beside it out of registers
  int depth_ = 0;
};

/// Traces what `work` hands out until there is nothing left. All threads of the block call it.
template <class Query, int block_size, class Work>
__device__ void trace_persistent(const TriangleTree& tree, PersistentMemory<block_size>& memory,
                                 Work& work) {
  // Any hit ends a ray, so its triangles are tested at once; the closest one waits for company.
  constexpr int triangles_least = sizeof(Query) == sizeof(AnyTriangle) ? 1 : 12;
  memory.order.fill();
  __syncthreads();
  uint2 stack[bvh_depth_max];
  PersistentTracer<Query, triangles_least, Work> tracer(tree, work, memory.order,
                                                        memory.warps[threadIdx.x / 32], stack);
  tracer.run();
}

}  // namespace pt
