// Warp-level phase voting, the megakernel's body for wide trees (--kernel vote): a warp votes on
// whether its lanes step down the tree, test leaves or are shaded next (as the `if-if` traversal of
// Aila and Laine 2009, with shading as a further phase).
//
// In trace_path.h a warp waits in every iteration for the longest of 32 traversals. Here a lane
// steps down the tree or tests a leaf until its ray ends, and then waits to be shaded. The warp
// leaves the traversal when enough lanes wait, shades these together, which begins their shadow
// rays, their next rays or new paths, and resumes all. A path goes through the same functions in
// the same order as in the loop, so its radiance is the same, bit for bit.
#pragma once

#include "common/accel/trace_cuda/choose_next.cuh"
#include "common/accel/trace_cuda/cwbvh_lane.cuh"
#include "common/block_wavefront/path_query.cuh"
#include "common/film/film.h"
#include "common/transport/extra_state.h"
#include "common/transport/path_step.h"

namespace pt {

/// When a warp leaves the traversal: lanes of 32 that have a path; of fewer, in proportion.
struct PhaseVotingTuning {
  static constexpr int shade = 20;    ///< lanes that wait to be shaded
  static constexpr int next_ray = 4;  ///< lanes whose shadow ray has ended and whose next ray waits
};

/// The paths of a warp while their rays are traced, by lane, in shared memory: traversal and
/// shading need all registers. Each lane sees its own alone.
struct PhaseVotingWarp {
  PreparedRays rays, shadow_rays;
  float4 direction[32];          ///< of the ray; the path's index
  float4 throughput[32];         ///< beta; rays and shadow rays
  float4 radiance[32];           ///< so far; the receiver
  float shadow_radiance[3][32];  ///< to be added if the shadow ray is not occluded
  float bsdf_pdf[32];
};

/// With room for a lane's suspended traversal beyond the stack.
inline constexpr int phase_voting_stack_size =
    CwbvhLane<PathQuery>::stack_size + CwbvhLane<PathQuery>::suspended_size;

/// One lane's view. Traits: of triangles without masks and instances; Source: one whose streams are
/// opened again for each draw; Work: see trace_path.h.
template <class Traits, class Source, class Work, bool carries = carries_extra<Source>>
class PhaseVotingTracer {
 public:
  __device__ PhaseVotingTracer(const Scene& scene, const Source& source,
                               const SampleBuffer& samples, const PathSettings& settings,
                               Work& work, const SlotOrder& order, PhaseVotingWarp& warp,
                               unsigned lane, const ExtraState& extra, uint2* stack)
      : scene_(scene),
        source_(source),
        samples_(samples),
        path_settings_(settings),
        work_(work),
        warp_(warp),
        lane_(lane),
        extra_(extra),
        ray_(scene.triangles, order, stack),
        suspended_(stack + CwbvhLane<PathQuery>::stack_size) {}

  /// By the whole warp; returns when no paths are left.
  __device__ __forceinline__ void run() {
    int live = 32;  // lanes that have a path, or may get one
    while (true) {
      const bool tests = ray_.wants_test(), steps = ray_.wants_step();
      const int testing = __popc(__ballot_sync(whole_warp, tests));
      const int stepping = __popc(__ballot_sync(whole_warp, steps));
      const int waiting = live - testing - stepping;
      const auto are_enough = [&](int lanes, int of_32) { return lanes * 32 >= live * of_32; };
      if (are_enough(waiting, PhaseVotingTuning::next_ray)) {
        const bool begins_next = state_ == State::shadow_then_ray && !tests && !steps;
        const int beginning = __popc(__ballot_sync(whole_warp, begins_next));
        const bool shades = are_enough(waiting - beginning, PhaseVotingTuning::shade);
        if (shades || testing + stepping == 0 ||
            are_enough(beginning, PhaseVotingTuning::next_ray)) {
          if (begins_next) begin_next_ray();
          if (!shades) continue;
          shade(state_ != State::idle && !tests && !steps && !begins_next);
          live = __popc(__ballot_sync(whole_warp, state_ != State::idle));
          if (live == 0) return;
          continue;
        }
      }
      if (warp_steps(stepping, testing)) {
        if (steps) ray_.step();
      } else if (tests) {
        ray_.test_leaf(work_);
      }
    }
  }

 private:
  static constexpr unsigned whole_warp = 0xffffffffu;
  static_assert(PhaseVotingTuning::next_ray <= PhaseVotingTuning::shade &&
                PhaseVotingTuning::shade <= 32);

  /// What the lane traces, and what comes then.
  enum class State : std::uint8_t { no_path, ray, shadow_then_ray, shadow_then_end, idle };

  __device__ bool traces_shadow() const {
    return state_ == State::shadow_then_ray || state_ == State::shadow_then_end;
  }

  __device__ PathState load_path() const {
    const float4 beta = warp_.throughput[lane_];
    const std::uint32_t rays = __float_as_uint(beta.w);
    PathState path;
    path.beta = {beta.x, beta.y, beta.z};
    path.index = __float_as_uint(warp_.direction[lane_].w);
    path.rays = static_cast<std::uint16_t>(rays);
    path.shadow_rays = static_cast<std::uint16_t>(rays >> 16);
    path.bsdf_pdf = warp_.bsdf_pdf[lane_];
    path.receiver = {__float_as_uint(warp_.radiance[lane_].w)};
    return path;
  }

  __device__ Color load_radiance() const {
    const float4 radiance = warp_.radiance[lane_];
    return {radiance.x, radiance.y, radiance.z};
  }

  __device__ void store(const PathState& path, const Color& radiance, const Vec3& direction) {
    const auto bits = [](std::uint32_t x) { return __uint_as_float(x); };
    warp_.direction[lane_] = {direction.x, direction.y, direction.z, bits(path.index)};
    warp_.throughput[lane_] = {path.beta.x, path.beta.y, path.beta.z, bits(path.packed_rays())};
    warp_.radiance[lane_] = {radiance.x, radiance.y, radiance.z, bits(path.receiver.bits)};
    warp_.bsdf_pdf[lane_] = path.bsdf_pdf;
  }

  /// The path's radiance with what its shadow ray has found.
  __device__ Color lit_radiance() const {
    const Color radiance = load_radiance();
    if (!ray_.query().result().is_miss()) return radiance;
    return radiance + Color(warp_.shadow_radiance[0][lane_], warp_.shadow_radiance[1][lane_],
                            warp_.shadow_radiance[2][lane_]);
  }

  /// The shadow ray has ended; the path's next ray is ready.
  __device__ void begin_next_ray() {
    const Color radiance = lit_radiance();
    warp_.radiance[lane_] = {radiance.x, radiance.y, radiance.z, warp_.radiance[lane_].w};
    state_ = State::ray;
    if constexpr (counts_lanes) {
      set_lanes(ray_, lanes_of(scene_).at(load_path().rays));
      lanes_of(ray_).count(LanePoint::intersect);
    }
    begin(warp_.rays.load(lane_));
  }

  __device__ void begin(const PreparedRay& ray) { ray_.begin(ray, query_of(ray)); }

  __device__ PathQuery query_of(const PreparedRay& ray) const {
    return {0.0f, ray.t_max, traces_shadow()};
  }

  /// By the whole warp; lanes that wait get something to trace, as far as there are paths.
  __device__ __forceinline__ void shade(bool waits) {
    PathState path;
    Color radiance(0.0f);
    Ray ray;
    Hit hit;
    bool ended = waits && state_ != State::ray;
    // All lanes: so those that were traversing need no registers while others are shaded.
    ray_.suspend(suspended_);
    if (waits && state_ == State::shadow_then_end) {
      samples_.store(load_path(), lit_radiance());
    } else if (waits && state_ == State::ray) {
      hit = ray_.query().result();
      const float4 direction = warp_.direction[lane_];
      ray = {warp_.rays.load(lane_).origin, {direction.x, direction.y, direction.z}};
      path = load_path();
      radiance = load_radiance();
      set_lanes(ray, lanes_of(scene_).at(path.rays));
      ++path.rays;
      if (hit.is_miss()) {
        if constexpr (carries) {
          if (!extra_.is_whole(lane_, path)) radiance = broken_radiance();
        }
        PathSample sample{samples_, radiance};
        shade_miss<Traits::lighting>(scene_, ray.direction, path, path_settings_, sample);
        ended = true;
      }
    }
    if (__any_sync(whole_warp, ended)) {
      std::uint32_t path_index = 0;
      const bool has_path = work_.next(path_index, ended);
      if (ended) {
        state_ = has_path ? State::ray : State::idle;
        path = PathState{};
        path.index = path_index;
        radiance = Color(0.0f);
      }
    }
    const bool works = waits && state_ != State::idle;
    if (works) continue_path(path, radiance, ray, hit);
    const PreparedRay prepared =
        traces_shadow() ? warp_.shadow_rays.load(lane_) : warp_.rays.load(lane_);
    ray_.resume(prepared, query_of(prepared), suspended_, work_);
    if (works && state_ != State::no_path) begin(prepared);
  }

  /// A path begins at the camera or continues from a surface.
  __device__ __forceinline__ void continue_path(PathState path, Color radiance, Ray ray,
                                                const Hit& hit) {
    lanes_of(scene_).at(path.rays).count(LanePoint::iteration);
    const PathId id = samples_.id_of(path.index);
    typename Source::Stream random = source_.open(id);
    const Vec4 u = random.draw(scatter_block(path.rays));
    LaneSink sink{*this, radiance, ray};
    if (path.rays == 0) {
      sink.continue_path(path, generate_camera_path(scene_, random, id.pixel, u));
    } else {
      shade_surface<Traits>(scene_, ray, hit, path, path_settings_,
                            eager_shading<Traits>(u, random, path), sink);
    }
    if constexpr (carries) carry_extra(path, sink.state, radiance);
    store(path, radiance, ray.direction);
    state_ = sink.state;
  }

  /// What the path carries, when it has begun or been shaded.
  __device__ void carry_extra(const PathState& path, State state, Color& radiance) {
    if (path.rays == 0) return extra_.begin(lane_, path.index);
    if (state == State::ray || state == State::shadow_then_ray) return extra_.step(lane_);
    if (extra_.is_whole(lane_, path)) return;
    radiance = broken_radiance();
    samples_.store(path, radiance);
  }

  /// A sink (transport/path_step.h): rays into the lane's part of the warp's memory.
  struct LaneSink {
    PhaseVotingTracer& tracer;
    Color& radiance;
    Ray& ray;  ///< the path's next one
    State state = State::no_path;

    __device__ void emit(const PathState&, const Color& emitted) { radiance += emitted; }
    __device__ void cast(const PathState&, const ShadowRay& shadow) {
      PhaseVotingWarp& warp = tracer.warp_;
      const unsigned lane = tracer.lane_;
      warp.shadow_rays.store(lane, {shadow.ray.origin, 0.0f, shadow.ray.direction, shadow.distance},
                             0);
      for (int c = 0; c < 3; ++c) warp.shadow_radiance[c][lane] = shadow.radiance[c];
      count_begun(shadow.ray);
      state = State::shadow_then_end;
    }
    __device__ void continue_path(const PathState&, const Ray& next) {
      ray = next;
      tracer.warp_.rays.store(tracer.lane_, {ray.origin, 0.0f, ray.direction, infinite_distance},
                              0);
      if (state == State::no_path) count_begun(ray);
      state = state == State::no_path ? State::ray : State::shadow_then_ray;
    }
    __device__ void end(const PathState& path) {
      if (state == State::no_path) tracer.samples_.store(path, radiance);
    }

   private:
    __device__ void count_begun(const Ray& traced) {
      set_lanes(tracer.ray_, lanes_of(traced));
      lanes_of(tracer.ray_).count(LanePoint::intersect);
    }
  };

  const Scene& scene_;
  const Source& source_;
  const SampleBuffer& samples_;
  const PathSettings& path_settings_;
  Work& work_;
  PhaseVotingWarp& warp_;
  unsigned lane_;
  [[no_unique_address]] const ExtraStateIf<carries> extra_;
  CwbvhLane<PathQuery> ray_;
  volatile uint2* suspended_;
  State state_ = State::no_path;
};

}  // namespace pt
