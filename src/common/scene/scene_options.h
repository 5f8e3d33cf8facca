// Which scenes an option's value is for.
#pragma once

#include "common/render/options.h"
#include "common/scene/scene_data.h"

namespace pt {

/// Whether the scene has nothing that the paper's have not.
bool has_primitives_only(const SceneData& scene);

/// Whether the lean kernels of the paper's scenes can render it as the options say; else those of
/// all other scenes do, which have more ways to sample.
bool has_specialized_kernels(const SceneData& scene, const Options& options);

/// Throws Error when the options ask for what this scene cannot have.
void check_scene_options(const Options& options, const SceneData& scene);

/// More threads in a block would leave too few registers to a megakernel whose warps vote.
inline constexpr int phase_voting_threads_max = 256;

/// Whether the options suit it (megakernel/trace_paths_voting.cuh): warps fetch paths, and blocks
/// are of whole warps, at most so many.
inline bool may_vote(const Options& options) {
  const int threads = options.block.x * options.block.y;
  return options.work == Work::persistent && threads % 32 == 0 &&
         threads <= phase_voting_threads_max;
}

inline bool is_on_cuda(const Options& options) {
  return options.device.kind == DeviceChoice::Kind::cuda && options.mode != Mode::serial;
}

/// Whether one of the paper's toggles is on that have kernels of their own; on CUDA these are for
/// scenes that brute force scans.
inline bool is_toggled(const Options& options) {
  return options.rng != RngKind::philox || options.branching != Branching::divergent;
}

/// Whether a megakernel whose blocks sort suits the options if nobody asks for it: it has blocks of
/// its own (megakernel/trace_paths_sorting.cuh).
inline bool may_sort(const Options& options) {
  constexpr BlockSize usual;
  return options.work == Work::persistent && options.block.x == usual.x &&
         options.block.y == usual.y;
}

/// The megakernel on CUDA that suits scenes of triangles alone if nobody chooses one: blocks that
/// sort; with other blocks warps that vote where there is one kind of BSDF and no mask, and loops
/// else (results/ has the measurements).
MegakernelKind automatic_kernel(const SceneData& scene, const Options& options);

}  // namespace pt
