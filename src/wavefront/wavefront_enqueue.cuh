// One wave as kernel launches: the Executor of run_wave on CUDA, for the files that instantiate it.
#pragma once

#include "common/device/cuda/curand_state.cuh"
#include "wavefront/stage_kernel.cuh"
#include "wavefront/wavefront_cuda.h"

namespace pt {

/// What statistics call the stage's kernel.
template <class Stage>
std::string kernel_name(const Stage& stage) {
  std::string name = to_string(id_of(stage));
  if constexpr (requires { Stage::variant; }) name += std::string("/") + Stage::variant;
  return name;
}

/// Stages of which a thread traces a ray alone walk binary trees, and wide ones over triangles;
/// persistent warps walk the others (check_plan). With lights no shared memory holds the spheres.
template <class Stage, SceneMemory>
inline constexpr bool has_kernel = true;
template <class T, SceneMemory memory>
inline constexpr bool has_kernel<IntersectRays<T>, memory> =
    T::accel != Accel::cwbvh || T::geometry == Geometry::triangles;
template <class T, SceneMemory memory>
inline constexpr bool has_kernel<TraceShadowRays<T>, memory> = has_kernel<IntersectRays<T>, memory>;
template <class T, class Source>
inline constexpr bool has_kernel<FollowPaths<T, Source>, SceneMemory::shared> = !T::has_lights;
/// Blocks finish paths in media where wide trees are traced.
template <class T, class Source>
inline constexpr bool has_kernel<FollowPaths<T, Source>, SceneMemory::global> =
    !T::has_media || T::accel == Accel::bvh2;

template <class Stage>
void WavefrontCuda::run(const Stage& stage, const StageQueues& queues) {
  const int block = options_.stage_block[static_cast<int>(id_of(stage))];
  const auto launch_with = [&](const auto& storage, std::size_t shared_bytes) {
    using Storage = std::remove_cvref_t<decltype(storage)>;
    if constexpr (has_kernel<Stage, Storage::memory>) {
      constexpr auto kernel = stage_kernel<Stage, Storage::memory>;
      const std::uint32_t blocks =
          (buffers_.pool.slot_count + static_cast<std::uint32_t>(block) - 1) / block;
      const std::uint32_t resident =
          resident_blocks(reinterpret_cast<const void*>(kernel), block, shared_bytes);
      launch(kernel_name(stage).c_str(), kernel, blocks < resident ? blocks : resident, block,
             shared_bytes, storage, stage, queues, clock());
    } else {
      throw_no_kernel(traits_, options_.integrator);
    }
  };
  if constexpr (Stage::spheres == SphereAccess::once) {
    launch_with(SceneStorage<SceneMemory::global>{scene_}, std::size_t{0});
  } else {
    with_scene_storage(
        [&](const auto& storage, std::size_t shared_bytes) { launch_with(storage, shared_bytes); });
  }
}

template <class Kinds, class Source>
void WavefrontCuda::enqueue_wave_of(const StageContext<Source>& context, bool starts_paths) {
  dispatch_traits(Kinds{}, traits_, options_.integrator, [&](auto traits) {
    constexpr bool may_reduce = may_reduce_on_cuda<decltype(traits), Source>;
    dispatch_branching<decltype(traits), may_reduce>(options_.branching, [&](auto branching) {
      run_wave<decltype(traits), decltype(branching)::value>(*this, buffers_, context,
                                                             starts_paths);
    });
  });
}

template <class Kinds, class Source>
void WavefrontCuda::enqueue_finish_of(const StageContext<Source>& context) {
  dispatch_traits(Kinds{}, traits_, options_.integrator,
                  [&](auto traits) { run_finish<decltype(traits)>(*this, buffers_, context); });
}

}  // namespace pt
