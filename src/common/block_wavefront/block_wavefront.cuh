// The block-local wavefront: a wavefront (Laine, Karras and Aila 2013) inside a thread block. It is
// the megakernel's body for many kinds of BSDFs (--kernel sort), and follows the last paths of the
// wavefront to their ends.
//
// Phase voting (megakernel/trace_paths_voting.cuh) shades the paths that wait in a warp, surfaces
// of several kinds by code that each warp fetches for itself. Here a block owns several paths for
// each of its threads and takes all of them through the same phases, a barrier between each and the
// next:
//
//   start   slots whose path has ended get a new one and its camera ray
//   trace   lanes take rays and shadow rays of the block, another one whenever theirs ends
//   sort    the paths whose rays have ended, by the kind of the BSDF that they hit
//   shade   in this order: threads side by side execute the same code, and so do all warps at about
//           the same time, which share what is in the instruction cache
//
// A phase of tracing does not wait for its longest rays: their traversal is suspended and resumed
// in the next one. A path goes through the same functions in the same order as in the loop
// (megakernel/trace_path.h), so its radiance is the same, bit for bit.
#pragma once

#include "common/accel/trace_cuda/cwbvh_lane.cuh"
#include "common/accel/trace_cuda/instanced_lane.cuh"
#include "common/accel/trace_cuda/persistent_cwbvh.cuh"
#include "common/block_wavefront/path_query.cuh"
#include "common/block_wavefront/path_share.h"
#include "common/device/cuda/counting_sort.cuh"
#include "common/film/film.h"
#include "common/transport/mask.h"
#include "common/transport/path_step.h"
#include "common/transport/travel.h"

namespace pt {

struct BlockWavefrontTuning {
  static constexpr int slots_most = 12;     ///< of a thread (PathShare::slots_per_thread)
  static constexpr int suspended_max = 12;  ///< lanes of a warp that a phase may suspend
};

/// A lane of a block. Traits: of triangles, or of triangles and their instances without masks,
/// which may move.
template <class Traits>
using BlockWavefrontLane = std::conditional_t<
    Traits::has_instances,
    InstancedLane<std::conditional_t<Traits::has_motion, TimedQuery<PathQuery>, PathQuery>>,
    CwbvhLane<std::conditional_t<Traits::has_masks, MaskedPathQuery, PathQuery>, true>>;

/// What a block shares, in shared memory: of `slots` as many as the block has.
template <class Lane, int threads>
struct BlockWavefrontMemory {
  static constexpr int class_count = kind_count + 1;  ///< misses come first

  /// What the path of a slot waits for.
  enum class Path : std::uint8_t {
    none,   ///< there is none
    ray,    ///< for its ray
    ended,  ///< for its last shadow ray
    miss,   ///< to be ended: its ray left the scene
    hit,    ///< to be shaded
  };
  /// And its shadow ray.
  enum class Shadow : std::uint8_t {
    none,  ///< there is none, or it was occluded
    ray,   ///< is traced
    free,  ///< not occluded: its radiance is to be added
  };

  /// What a slot waits for, and one entry of each list.
  struct SlotState {
    std::uint16_t rays[2];  ///< to be traced: see BlockRays
    std::uint16_t ordered;  ///< slots to be shaded, by kind
    std::uint16_t free;     ///< slots whose paths have ended
    Path path;
    Shadow shadow;
  };

  PersistentMemory<Lane, threads> tracing;
  std::uint32_t ray_end;  ///< of `rays`, while it is filled
  std::uint32_t ray_count, next_ray;
  std::uint32_t free_end;                                        ///< of `free_slots`
  std::uint32_t start_count, first_free, start_ray, first_path;  ///< of the slots that get a path
  std::uint32_t suspended;                                       ///< lanes
  bool has_ended;                                                ///< no path is left
  std::uint32_t next_shaded;
  std::uint32_t counts[class_count], first[class_count];  ///< of the slots to be shaded, by class
  SlotState slots[threads * BlockWavefrontTuning::slots_most];

  static constexpr std::size_t bytes(int slots_per_thread) {
    const int fewer = BlockWavefrontTuning::slots_most - slots_per_thread;
    return sizeof(BlockWavefrontMemory) - sizeof(SlotState) * threads * fewer;
  }

  __device__ std::uint16_t& ray(std::uint32_t i) { return slots[i / 2].rays[i % 2]; }
  __device__ std::uint16_t& ordered(std::uint32_t i) { return slots[i].ordered; }
  __device__ std::uint16_t& free_slot(std::uint32_t i) { return slots[i].free; }
  __device__ Path& path(std::uint32_t slot) { return slots[slot].path; }
  __device__ Shadow& shadow(std::uint32_t slot) { return slots[slot].shadow; }
};

/// Reserves an entry at the end of a list where `wanted`, and returns its index. By whole warps.
__device__ inline std::uint32_t take_end(std::uint32_t& end, bool wanted) {
  const unsigned votes = __ballot_sync(0xffffffffu, wanted);
  if (votes == 0) return 0;
  const unsigned lane = threadIdx.x & 31;
  std::uint32_t first = 0;
  if (lane == 0) first = atomicAdd(&end, __popc(votes));
  return __shfl_sync(0xffffffffu, first, 0) + __popc(votes & ((1u << lane) - 1));
}

/// The block's rays for PersistentTracer. A ray's id is twice its slot; of a shadow ray one more.
template <class Traits, class Memory>
struct BlockRays {
  using Query = typename BlockWavefrontLane<Traits>::Query;
  using Path = typename Memory::Path;
  using Shadow = typename Memory::Shadow;
  Memory& memory;
  PathSlot* slots;
  const Scene& scene;
  const SampleBuffer& samples;

  __device__ static bool is_shadow(std::uint32_t ray_id) { return (ray_id & 1u) != 0; }

  __device__ RayRecord record(std::uint32_t ray_id) const {
    const PathSlot& slot = slots[ray_id / 2];
    float distance = infinite_distance;
    const Ray ray = is_shadow(ray_id) ? slot.load_shadow_ray(distance) : slot.load_ray();
    float key = 0.0f;  // instead of t_min, which is 0
    if constexpr (Traits::has_masks) {
      const std::uint32_t ray_key = key_of(ray_id);
      if (!is_shadow(ray_id)) distance = ray_length(scene, ray.direction, ray_key);
      key = __uint_as_float(ray_key);
    }
    if constexpr (Traits::has_motion && Traits::has_instances) {  // the time, instead of t_min
      key = shutter_time(scene, samples.id_of(slot.load_path_index()));
    }
    return {ray.origin, key, ray.direction, distance};
  }

  __device__ std::uint32_t fetch(unsigned lane, ReservedRays&, RayRecord& next, int& count) const {
    std::uint32_t first = 0;
    if (lane == 0) first = atomicAdd(&memory.next_ray, 32u);
    first = __shfl_sync(0xffffffffu, first, 0);
    const std::uint32_t all = memory.ray_count;
    count = first < all ? static_cast<int>(min(32u, all - first)) : 0;
    if (static_cast<int>(lane) < count) next = record(id_of(first + lane));
    return first;
  }

  __device__ std::uint32_t id_of(std::uint32_t index) const { return memory.ray(index); }

  /// `ray`: as a warp keeps it.
  __device__ Query query(const auto& ray) const {
    return with_key(PathQuery(0.0f, ray.t_max, is_shadow(ray.id)), ray.t_min);
  }
  __device__ static Query with_key(const PathQuery& query, [[maybe_unused]] float key) {
    if constexpr (Traits::has_masks) {
      return {query, __float_as_uint(key)};
    } else if constexpr (Traits::has_motion && Traits::has_instances) {
      return {query, key};
    } else {
      return query;
    }
  }

  __device__ bool hides(const Query& query, std::uint32_t slot, const TriangleHit& hit) const {
    return mask_hides(MaskView(scene), scene.triangles.triangles, query.key(), slot, hit.b1,
                      hit.b2);
  }

  __device__ InstanceRecord placed(const InstanceRecord& instance, float time) const {
    return placed_at(instance, *scene.motion, time);
  }

  __device__ void finish(std::uint32_t ray_id, const Query& query) const {
    const std::uint32_t slot = ray_id / 2;
    const Hit hit = query.result();
    if (is_shadow(ray_id)) {
      memory.shadow(slot) = hit.is_miss() ? Shadow::free : Shadow::none;
    } else if (hit.is_miss()) {
      memory.path(slot) = Path::miss;
    } else {
      slots[slot].store_hit(hit);
      memory.path(slot) = Path::hit;
    }
  }

  __device__ LaneCounter lanes(std::uint32_t ray_id) const {
    const std::uint32_t rays = slots[ray_id / 2].load_rays();
    const LaneCounter all = lanes_of(scene);
    return is_shadow(ray_id) ? all.at(rays - 1).of_shadow_ray() : all.at(rays);
  }

 private:
  __device__ std::uint32_t key_of(std::uint32_t ray_id) const {
    const PathSlot& slot = slots[ray_id / 2];
    const std::uint32_t key = path_hash<Traits>(scene, samples.id_of(slot.load_path_index()));
    return is_shadow(ray_id) ? shadow_ray_key(scene, key, slot.load_rays())
                             : next_ray_key(scene, key, slot.load_rays());
  }
};

/// With room for a lane's suspended traversal beyond the stack.
template <class Lane>
inline constexpr int block_wavefront_stack_size = Lane::stack_size + Lane::suspended_size;

/// A sink (transport/path_step.h) that keeps a path in its slot. `streams`: it takes results as
/// shading finds them (StreamingShading).
template <bool streams = true, bool has_media = false>
struct SlotSink {
  const SampleBuffer& samples;
  PathSlot& slot;
  PathRecord* medium = nullptr;  ///< of the path, with has_media
  bool casts = false, alive = false;

  PT_HD void emit(const PathState&, const Color& emitted) {
    if (!is_black(emitted)) slot.add_radiance(emitted);
  }
  PT_HD void aim(const PathState&, const ShadowRay& shadow) { slot.store_shadow_ray(shadow); }
  PT_HD void cast(const PathState&, const ShadowRay& shadow) {
    if constexpr (!streams) slot.store_shadow_ray(shadow);
    slot.store_shadow_radiance(shadow.radiance, has_media ? shadow.medium_id : no_medium);
    casts = true;
  }
  PT_HD void continue_path(const PathState& path, const Ray& ray) {
    slot.store_path(path, ray);
    if constexpr (has_media) store_wide(medium, pack_medium(path.medium));
    alive = true;
  }
  PT_HD void end(const PathState& path) {
    if (casts) {
      slot.store_path(path, Ray());  // its counts; it ends with its shadow ray
    } else {
      samples.store(path, slot.load_radiance());
    }
  }
};

// Few paths are in media, and what these need must not cost all others registers: calls, all of
// whose parameters are values.

struct TravelledPath {
  PathState path;
  Hit hit;
};

PT_NOINLINE inline TravelledPath travel_out_of_line(const Scene& scene, Ray ray,
                                                    std::uint32_t path_key, PathState path,
                                                    Hit hit) {
  FreeFlight flight;
  travel<false>(scene, ray, path_key, to_the_end, path, flight, hit);
  return {path, hit};
}

/// What of a slot's shadow ray its medium lets through.
PT_NOINLINE inline Color shadow_passes_out_of_line(const Scene& scene, std::uint16_t medium_id,
                                                   const PathSlot& slot, std::uint32_t ray_key) {
  float distance;
  const Ray ray = slot.load_shadow_ray(distance);
  return segment_transmittance<false>(scene, medium_id, ray, distance, ray_key, 0);
}

/// One thread's view. Traits: as for BlockWavefrontLane; Source: one whose streams are opened again
/// for each draw; `carries`: paths carry extra records.
template <class Traits, class Source, class Memory, bool carries = carries_extra<Source>>
class BlockWavefront {
 public:
  __device__ BlockWavefront(const Scene& scene, const Source& source, const SampleBuffer& samples,
                            const PathSettings& settings, const PathShare& paths, Memory& memory,
                            const BlockSlots& slots, uint2* stack)
      : scene_(scene),
        source_(source),
        samples_(samples),
        path_settings_(settings),
        paths_(paths),
        memory_(memory),
        warp_(memory.tracing.warps[threadIdx.x / 32]),
        slots_(slots.paths),
        media_(slots.media),
        extra_(slots.extra),
        rays_{memory, slots.paths, scene, samples},
        stack_(stack) {}

  /// By the whole block; returns when no paths are left. `begun`: paths that lie in its first slots
  /// and wait for their rays.
  __device__ __forceinline__ void run(std::uint32_t begun) {
    fill(begun);
    while (start()) {
      trace();
      __syncthreads();
      sort();
      shade();
    }
  }

 private:
  using Path = typename Memory::Path;
  using Shadow = typename Memory::Shadow;
  using Lane = BlockWavefrontLane<Traits>;
  using Shading = ShadingTraits<Traits>;

  /// The k-th that this thread looks after where a block goes through all of its slots.
  __device__ static std::uint32_t slot_of(int k) { return k * blockDim.x + threadIdx.x; }

  __device__ void fill(std::uint32_t begun) {
    for (int k = 0; k < paths_.slots_per_thread; ++k) {
      const std::uint32_t slot = slot_of(k);
      const bool has_path = slot < begun;
      if (has_path) {
        memory_.ray(slot) = static_cast<std::uint16_t>(2 * slot);
      } else {
        memory_.free_slot(slot - begun) = static_cast<std::uint16_t>(slot);
      }
      memory_.path(slot) = has_path ? Path::ray : Path::none;
      memory_.shadow(slot) = Shadow::none;
    }
    warp_.ray_id[threadIdx.x & 31] = PersistentWarp<Lane>::none;
    if (threadIdx.x == 0) {
      memory_.free_end = paths_.slots_per_thread * blockDim.x - begun;
      memory_.ray_end = begun;
      memory_.suspended = 0;
    }
    memory_.tracing.order.fill();
  }

  /// Free slots get new paths. False: there is nothing left to do.
  __device__ __forceinline__ bool start() {
    __syncthreads();
    if (threadIdx.x == 0) take_paths();
    if (threadIdx.x < Memory::class_count) memory_.counts[threadIdx.x] = 0;
    __syncthreads();
    const std::uint32_t count = memory_.start_count;
    for (std::uint32_t i = threadIdx.x; i < count; i += blockDim.x) {
      const std::uint32_t slot = memory_.free_slot(memory_.first_free + i);
      const std::uint32_t path_index = memory_.first_path + i;
      const bool exists = path_index < samples_.path_count;
      memory_.path(slot) = exists ? Path::ray : Path::none;
      if (!exists) continue;
      memory_.ray(memory_.start_ray + i) = static_cast<std::uint16_t>(2 * slot);
      start_path(slots_[slot], path_index);
      if constexpr (carries) extra_.begin(slot, path_index);
    }
    const bool goes_on = !memory_.has_ended;
    __syncthreads();
    return goes_on;
  }

  /// By one thread: as many paths as slots are free, or as one block may take at once. When there
  /// are no more, the remaining slots stay free.
  __device__ void take_paths() {
    const std::uint32_t count = min(memory_.free_end, paths_.at_once), all = samples_.path_count;
    const std::uint32_t first = count > 0 ? atomicAdd(paths_.next, count) : all;
    const std::uint32_t left = first < all ? all - first : 0;
    memory_.first_path = first;
    memory_.start_count = count;
    memory_.first_free = memory_.free_end - count;
    memory_.free_end = count < left ? memory_.first_free : 0;
    memory_.start_ray = memory_.ray_end;
    memory_.ray_count = memory_.ray_end + min(count, left);
    memory_.has_ended = memory_.ray_count == 0 && memory_.suspended == 0;
    memory_.next_ray = memory_.next_shaded = memory_.ray_end = memory_.suspended = 0;
  }

  __device__ void start_path(PathSlot& slot, std::uint32_t path_index) {
    lanes_of(scene_).at(0).count(LanePoint::iteration);
    const PathId id = samples_.id_of(path_index);
    typename Source::Stream random = source_.open(id);
    PathState path;
    path.index = path_index;
    set_time<Traits>(scene_, id, path);
    slot.store_path(path, begin_path<Traits::has_motion>(scene_, id, random, path.time));
    slot.store_radiance(Color(0.0f), path);
  }

  /// The hits of the block's rays. If there are many, the last ones of each warp are suspended;
  /// fewer than all that are traced, so that some end in each phase.
  __device__ __forceinline__ void trace() {
    const int suspended_max =
        memory_.ray_count > blockDim.x ? BlockWavefrontTuning::suspended_max : 0;
    PersistentTracer<Lane, const BlockRays<Traits, Memory>> tracer(
        scene_.triangles, rays_, memory_.tracing.order, warp_, stack_);
    resume(tracer.lane());
    tracer.run(suspended_max);
    suspend(tracer.lane());
  }

  // Volatile, see CwbvhLane::suspend.
  __device__ volatile uint2* suspended_state() const { return stack_ + Lane::stack_size; }

  __device__ void suspend(const Lane& lane) {
    if (!lane.is_active()) return;
    lane.suspend(suspended_state());
    atomicAdd(&memory_.suspended, 1u);
  }

  __device__ void resume(Lane& lane) {
    const unsigned lane_index = threadIdx.x & 31;
    const std::uint32_t ray_id = warp_.ray_id[lane_index];
    const bool suspended = ray_id != PersistentWarp<Lane>::none;
    if (suspended) {
      warp_.rays.store(lane_index, rays_.record(ray_id), ray_id);
      const auto ray = warp_.rays.load(lane_index);
      lane.resume(ray, rays_.query(ray), suspended_state(), rays_);
      if constexpr (counts_lanes) set_lanes(lane, rays_.lanes(ray_id));
    }
    __syncwarp();
  }

  /// The slot's sort key: 0 for a miss, else one more than the kind of the surface's BSDF; below 0
  /// while a ray of the path is not finished.
  __device__ int class_of(std::uint32_t slot) const {
    const Path path = memory_.path(slot);
    if (path <= Path::ray || memory_.shadow(slot) == Shadow::ray) return -1;
    if (path != Path::hit) return 0;
    const Hit hit = slots_[slot].load_hit();
    return 1 + static_cast<int>(scene_.material(material_index_at(scene_, hit)).kind);
  }

  __device__ __forceinline__ void sort() {
    constexpr int most = BlockWavefrontTuning::slots_most;
    const int count = paths_.slots_per_thread;
    int classes[most];
    std::uint32_t rank[most] = {};
    PT_UNROLL(12)
    for (int k = 0; k < most; ++k) classes[k] = k < count ? class_of(slot_of(k)) : -1;
    PT_UNROLL(12)
    for (int k = 0; k < most; ++k) {
      if (k < count) rank[k] = reserve_indices(memory_.counts, classes[k]);
    }
    __syncthreads();
    if (threadIdx.x < Memory::class_count) {
      memory_.first[threadIdx.x] = sum_before(memory_.counts, static_cast<int>(threadIdx.x));
    }
    __syncthreads();
    PT_UNROLL(12)
    for (int k = 0; k < most; ++k) {
      if (classes[k] < 0) continue;
      memory_.ordered(memory_.first[classes[k]] + rank[k]) = static_cast<std::uint16_t>(slot_of(k));
    }
    __syncthreads();
  }

  /// Warps take 32 paths at a time, in their order.
  __device__ __forceinline__ void shade() {
    constexpr int last = Memory::class_count - 1;
    const std::uint32_t count = memory_.first[last] + memory_.counts[last];
    const unsigned lane = threadIdx.x & 31;
    while (true) {
      std::uint32_t index = 0;
      if (lane == 0) index = atomicAdd(&memory_.next_shaded, 32u);
      index = __shfl_sync(0xffffffffu, index, 0);
      if (index >= count) return;
      index += lane;
      const bool has_path = index < count;
      std::uint32_t slot = 0;
      Path path = Path::hit;
      Shadow shadow = Shadow::none;
      if (has_path) {
        slot = memory_.ordered(index);
        path = memory_.path(slot), shadow = memory_.shadow(slot);
        shade_path(slot, path, shadow);
        memory_.path(slot) = path, memory_.shadow(slot) = shadow;
      }
      __syncwarp();
      append_ray(path == Path::ray, 2 * slot);
      append_ray(shadow == Shadow::ray, 2 * slot + 1);
      const bool is_free = path == Path::none;
      const std::uint32_t end = take_end(memory_.free_end, is_free);
      if (is_free) memory_.free_slot(end) = static_cast<std::uint16_t>(slot);
    }
  }

  __device__ void append_ray(bool wanted, std::uint32_t ray_id) {
    const std::uint32_t end = take_end(memory_.ray_end, wanted);
    if (wanted) memory_.ray(end) = static_cast<std::uint16_t>(ray_id);
  }

  /// Takes what the path has waited for, and leaves what it waits for then.
  __device__ __forceinline__ void shade_path(std::uint32_t slot_index, Path& state,
                                             Shadow& shadow) {
    PathSlot& slot = slots_[slot_index];
    Color radiance;
    Ray ray;
    PathState path = slot.load_path(radiance, ray);
    if constexpr (Traits::has_motion) set_time<Traits>(scene_, samples_.id_of(path.index), path);
    const bool is_lit = shadow == Shadow::free;
    if (is_lit) radiance += light_that_arrives(slot, path);
    shadow = Shadow::none;
    PathSample sample{samples_, radiance};
    if (state == Path::ended) {
      sample.end(path);
      state = Path::none;
      return;
    }
    set_lanes(ray, lanes_of(scene_).at(path.rays));
    Hit hit;
    if (state == Path::hit) hit = slot.load_hit();
    if constexpr (Traits::has_media) fly(slot_index, ray, path, hit);
    ++path.rays;
    if (hit.is_miss()) {
      if constexpr (carries) {
        if (!extra_.is_whole(slot_index, path)) sample.radiance = broken_radiance();
      }
      shade_miss<Traits::lighting>(scene_, ray.direction, path, path_settings_, sample);
      state = Path::none;
      return;
    }
    if (is_lit) slot.store_radiance(radiance, path);
    lanes_of(scene_).at(path.rays).count(LanePoint::iteration);
    PathRecord* const medium = Traits::has_media ? media_ + slot_index : nullptr;
    if constexpr (Traits::has_media) {
      if (hit.is_collision()) {
        SlotSink<false, true> sink{samples_, slot, medium};
        auto random = source_.open(samples_.id_of(path.index));
        const EagerShading policy = eager_shading<Traits>(random, path);
        shade_medium<Shading>(scene_, ray, hit.t, path, path_settings_, policy, sink);
        return wait(slot_index, path, sink, state, shadow);
      }
    }
    SlotSink<true, Traits::has_media> sink{samples_, slot, medium};
    const StreamingShading policy{source_, samples_, path, sink};
    shade_surface<Shading>(scene_, ray, hit, path, path_settings_, policy, sink);
    wait(slot_index, path, sink, state, shadow);
  }

  /// What the sink leaves a path to wait for, which carries its records there.
  template <class Sink>
  __device__ void wait(std::uint32_t slot, const PathState& path, const Sink& sink, Path& state,
                       Shadow& shadow) const {
    if constexpr (carries) {
      if (sink.alive) {
        extra_.step(slot);
      } else if (!extra_.is_whole(slot, path)) {
        slots_[slot].add_radiance(broken_radiance());
        if (!sink.casts) samples_.store(path, broken_radiance());
      }
    }
    state = sink.alive ? Path::ray : sink.casts ? Path::ended : Path::none;
    shadow = sink.casts ? Shadow::ray : Shadow::none;
  }

  /// The path's flight through its medium, to `hit` or to a collision before it.
  __device__ void fly(std::uint32_t slot_index, const Ray& ray, PathState& path, Hit& hit) const {
    if (path.rays > 0) path.medium = unpack_medium(load_wide(media_ + slot_index));
    if (path.rays > 0 && path.medium.id == no_medium) return;
    const TravelledPath there = travel_out_of_line(scene_, ray, key_of(path), path, hit);
    path = there.path, hit = there.hit;
  }

  /// The radiance of a shadow ray that nothing occludes, attenuated by its medium.
  __device__ Color light_that_arrives(const PathSlot& slot, const PathState& path) const {
    if constexpr (!Traits::has_media) return slot.load_shadow_radiance();
    std::uint16_t medium_id;
    const Color radiance = slot.load_shadow_radiance(medium_id);
    if (medium_id == no_medium) return radiance;
    const std::uint32_t key = shadow_ray_key(scene_, key_of(path), path.rays);
    return radiance * shadow_passes_out_of_line(scene_, medium_id, slot, key);
  }

  __device__ std::uint32_t key_of(const PathState& path) const {
    return path_hash<Traits>(scene_, samples_.id_of(path.index));
  }

  const Scene& scene_;
  const Source& source_;
  const SampleBuffer& samples_;
  const PathSettings& path_settings_;
  const PathShare& paths_;
  Memory& memory_;
  PersistentWarp<Lane>& warp_;
  PathSlot* slots_;
  PathRecord* media_;
  [[no_unique_address]] const ExtraStateIf<carries> extra_;
  const BlockRays<Traits, Memory> rays_;
  uint2* stack_;
};

}  // namespace pt
