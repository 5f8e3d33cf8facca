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

/// Whether the table of kernels has the stage, for the stages that trace rays. RayTraits say
/// nothing of the scene's lights.
template <class Stage, SceneMemory>
inline constexpr bool is_in_table = true;
template <class T, SceneMemory memory>
inline constexpr bool is_in_table<IntersectRays<T>, memory> = traces_rays(T::value(), memory);
template <class T, SceneMemory memory>
inline constexpr bool is_in_table<TraceShadowRays<T>, memory> = traces_rays(T::value(), memory);
template <class T, class Source, SceneMemory memory>
inline constexpr bool is_in_table<FollowPaths<T, Source>, memory> =
    KernelSelection<true, Source, memory, KernelBody::fused>::has(T::value());

template <class Stage>
void WavefrontCuda::run(const Stage& stage, const StageQueues& queues) {
  const int block = plan_.stage_block[static_cast<int>(id_of(stage))];
  const auto launch_with = [&](const auto& storage, std::size_t shared_bytes) {
    using Storage = std::remove_cvref_t<decltype(storage)>;
    if constexpr (is_in_table<Stage, Storage::memory>) {
      constexpr auto kernel = stage_kernel<Stage, Storage::memory>;
      const std::uint32_t blocks =
          (buffers_.pool.slot_count + static_cast<std::uint32_t>(block) - 1) / block;
      const std::uint32_t resident =
          resident_blocks(reinterpret_cast<const void*>(kernel), block, shared_bytes);
      launch(kernel_name(stage).c_str(), kernel, blocks < resident ? blocks : resident, block,
             shared_bytes, storage, stage, queues, clock());
    } else {
      throw_no_kernel(traits_);
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
  dispatch_traits(Kinds{}, traits_, [&](auto traits) {
    using Kind = decltype(traits);
    dispatch_branching<true, Kind, Source, SceneMemory::global, KernelBody::stages>(
        plan_.branching, [&](auto branching) {
          run_wave<Kind, decltype(branching)::value>(*this, buffers_, context, starts_paths);
        });
  });
}

template <class Kinds, class Source>
void WavefrontCuda::enqueue_finish_of(const StageContext<Source>& context) {
  dispatch_traits(Kinds{}, traits_,
                  [&](auto traits) { finish_paths<decltype(traits)>(*this, buffers_, context); });
}

}  // namespace pt
