// Persistent threads with dynamic fetch (Aila and Laine 2009) on a compressed wide tree, for
// incoherent rays.
//
// Rays differ in how many nodes they visit; a warp that waited for the slowest of 32 would be idle
// for most of its time. So a lane whose ray is done takes another one, as soon as `refill` lanes
// are idle. And the warp does one thing at a time, whatever more of its lanes wait for: steps down
// the tree or tests of leaves. All votes are explicit and by the whole warp: since Volta, threads
// that diverge do not reconverge without one.
#pragma once

#include "common/accel/ray_record.h"
#include "common/accel/trace_cuda/choose_next.cuh"
#include "common/platform/lane_counter.h"

namespace pt {

/// How many rays a warp reserves at once, of `left` that are shared by `threads` threads: an eighth
/// of what comes to a warp, a multiple of 32 up to 512. While many are left, few atomic operations:
/// one for every 32 rays costs long queues 1 to 2 % (results/). In the end, few rays: others would
/// have none while those of a slow warp wait in its reserve.
PT_HD std::uint32_t reserved_batch(std::uint32_t left, std::uint32_t threads) {
  constexpr std::uint32_t least = 32, most = 512;
  const std::uint32_t share = left / (threads / 4) & ~31u;
  return share < least ? least : share > most ? most : share;
}

/// All threads of the warp call it together, and get up to 32 rays with successive indices, one
/// each for the first `count` lanes; the first one's index is returned. `next` counts the rays
/// handed out, of `all`. By reserved.end the warp knows how many were left at its last reservation.
__device__ inline std::uint32_t reserve_rays(std::uint32_t* next, const std::uint32_t& all,
                                             unsigned lane, ReservedRays& reserved, int& count) {
  std::uint32_t first = reserved.next;
  if (first == reserved.end) {
    const std::uint32_t left = reserved.end < all ? all - reserved.end : 0;
    const std::uint32_t batch = reserved_batch(left, gridDim.x * blockDim.x);
    if (lane == 0) first = atomicAdd(next, batch);
    first = __shfl_sync(0xffffffffu, first, 0);
    reserved.end = first + batch;
  }
  __syncwarp();
  reserved.next = first + 32;
  const std::uint32_t total = all;  // in memory: read when it is needed, not before
  count = first < total ? static_cast<int>(min(32u, total - first)) : 0;
  return first;
}

/// What a warp needs rarely, in shared memory to save registers.
template <class Lane>
struct PersistentWarp {
  static constexpr std::uint32_t none = 0xffffffffu;

  typename Lane::Rays rays;
  typename Lane::Memory lanes;
  int next_ray, ray_count;   ///< of `rays`: those from next_ray on are not yet handed out
  std::uint32_t ray_id[32];  ///< by lane: of the ray whose result is not written; none
  ReservedRays reserved;
};

/// What the threads of a block share.
template <class Lane, int block_size>
struct PersistentMemory {
  SlotOrder order;
  PersistentWarp<Lane> warps[block_size / 32];
};

/// Threads of a block; 1024 of them, with 64 registers each, fill a multiprocessor, or 896 with 72.
/// Large blocks have fewer tables of children's order, which leaves L1 more: 256 with instances,
/// since more need over 48 kB.
template <class Lane>
inline constexpr int persistent_block = Lane::has_instances    ? 256
                                        : Lane::is_speculative ? 448
                                                               : 512;
template <class Lane>
inline constexpr int persistent_blocks_least = 1024 / persistent_block<Lane>;

struct PersistentTuning {
  static constexpr int refill = 8;  ///< idle lanes that make the warp hand out rays
};

/// Traces what `work` hands out, one lane's view. Lane: CwbvhLane or InstancedLane. Work has
///   std::uint32_t fetch(unsigned lane, ReservedRays&, RayRecord&, int& count)  by the whole warp:
///     up to 32 rays with successive indices, one each for the first `count` lanes; returns the
///     first's index; count 0: there is none left
///   void finish(std::uint32_t id, const Query&)  by lanes whose ray is done
///   bool hides(const Query&, std::uint32_t slot, const TriangleHit&)  where Query::has_masks: the
///     triangle's mask lets the ray through
///   InstanceRecord placed(const InstanceRecord&, float time)  where Query has a time: the instance
///     as it lies then
///   std::uint32_t id_of(std::uint32_t index)  if a ray's id is not its index
///   Query query(const PreparedRay&)  if its rays have queries of several kinds
///   LaneCounter lanes(std::uint32_t id)  if its rays' lanes are to be counted
template <class Lane, class Work>
class PersistentTracer {
 public:
  using Warp = PersistentWarp<Lane>;

  __device__ PersistentTracer(const TriangleTree& tree, Work& work, const SlotOrder& order,
                              Warp& warp, uint2* stack)
      : tree_(tree), work_(work), warp_(warp), lane_(tree, order, stack, warp.lanes) {}

  __device__ Lane& lane() { return lane_; }

  /// By the whole warp; returns when all rays are done.
  __device__ void run() {
    warp_.ray_id[threadIdx.x & 31] = Warp::none;
    run(0);
  }

  /// Likewise, with lanes that may have a ray already; returns when no more rays are handed out and
  /// at most `suspended_max` lanes still trace one.
  __device__ void run(int suspended_max) {
    warp_.next_ray = warp_.ray_count = 0;
    warp_.reserved = {0, 0};
    __syncwarp();
    int few = enough_idle;  // busy lanes; once no rays are left, what is waited for
    while (true) {
      const bool tests = lane_.wants_test(), steps = lane_.wants_step();
      const unsigned testing = __ballot_sync(whole_warp, tests);
      const unsigned stepping = __ballot_sync(whole_warp, steps);
      bool enters = false;
      unsigned entering = 0;
      if constexpr (Lane::has_instances) {
        enters = lane_.wants_enter();
        entering = __ballot_sync(whole_warp, enters);
      }
      const unsigned busy = testing | stepping | entering;
      const int busy_count = __popc(busy);
      if (busy_count <= few) {
        const bool is_drained = !refill(~busy);
        if (is_drained && busy_count <= suspended_max) return;
        few = is_drained ? suspended_max : enough_idle;
      } else {
        const Phase phase = choose_phase<Lane>(__popc(stepping), __popc(testing), __popc(entering));
        if (phase == Phase::step) {
          if (steps) lane_.step();
        } else if (phase == Phase::test) {
          if (tests) lane_.test_leaf(work_);
        } else if constexpr (Lane::has_instances) {
          if (enters) lane_.enter(work_);
        }
      }
    }
  }

 private:
  static constexpr unsigned whole_warp = 0xffffffffu;
  static constexpr int enough_idle = 32 - PersistentTuning::refill;

  /// Finishes the rays of idle lanes and hands out others. False: there were none.
  __device__ bool refill(unsigned idle) {
    const unsigned lane = threadIdx.x & 31;
    if (!lane_.is_active() && warp_.ray_id[lane] != Warp::none) {
      work_.finish(warp_.ray_id[lane], lane_.query());
      warp_.ray_id[lane] = Warp::none;
    }
    int next = warp_.next_ray, count = warp_.ray_count;
    bool are_left = next < count;
    int index = (idle >> lane & 1u) != 0 ? next + __popc(idle & ((1u << lane) - 1)) : -1;
    next += __popc(idle);
    __syncwarp();
    while (true) {
      if (index >= 0 && index < count) begin(warp_.rays.load(static_cast<unsigned>(index)));
      if (next <= count) break;
      index -= count, next -= count;  // lanes that got none
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
    if (static_cast<int>(lane) < count) prepare(lane, record, first + lane);
    __syncwarp();
    return count;
  }

  __device__ void prepare(unsigned lane, const RayRecord& record, std::uint32_t index) {
    std::uint32_t id = index;
    if constexpr (requires { work_.id_of(index); }) id = work_.id_of(index);
    warp_.rays.store(lane, record, id);
    if constexpr (Lane::is_speculative) {
      if constexpr (counts_lanes && requires { work_.lanes(id); }) {
        work_.lanes(id).count(LanePoint::node);
      }
      warp_.rays.meet_root(lane, tree_);
    }
  }

  __device__ void begin(const auto& ray) {
    warp_.ray_id[threadIdx.x & 31] = ray.id;
    if constexpr (counts_lanes && requires { work_.lanes(ray.id); }) {
      set_lanes(lane_, work_.lanes(ray.id));
      lanes_of(lane_).count(LanePoint::intersect);
    }
    if constexpr (requires { work_.query(ray); }) {
      lane_.begin(ray, work_.query(ray));
    } else {
      lane_.begin(ray, typename Lane::Query(ray.t_min, ray.t_max));
    }
  }

  const TriangleTree& tree_;
  Work& work_;
  Warp& warp_;
  Lane lane_;
};

/// Traces what `work` hands out until there is nothing left. All threads of the block call it.
template <class Lane, int block_size, class Work>
__device__ void trace_persistent(const TriangleTree& tree,
                                 PersistentMemory<Lane, block_size>& memory, Work& work) {
  memory.order.fill();
  __syncthreads();
  uint2 stack[Lane::stack_size];
  PersistentTracer<Lane, Work> tracer(tree, work, memory.order, memory.warps[threadIdx.x / 32],
                                      stack);
  tracer.run();
}

}  // namespace pt
