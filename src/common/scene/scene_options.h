// Which scenes an option's value is for.
#pragma once

#include "common/render/options.h"
#include "common/scene/scene_data.h"

namespace pt {

/// Whether the scene has only what the paper's scenes have.
bool has_primitives_only(const SceneData& scene);

/// Whether the kernels specialised for the paper's scenes can render it with these options; else
/// the general ones do, which have more sampling strategies.
bool has_specialized_kernels(const SceneData& scene, const Options& options);

/// Throws Error when the options ask for what this scene cannot have.
void check_scene_options(const Options& options, const SceneData& scene);

/// More threads in a block would leave too few registers for phase voting.
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

/// Whether the block-local wavefront suits the options without --kernel: it has a block size of its
/// own (megakernel/trace_paths_sorting.cuh).
inline bool may_sort(const Options& options) {
  constexpr BlockSize usual;
  return options.work == Work::persistent && options.block.x == usual.x &&
         options.block.y == usual.y;
}

/// The megakernel on CUDA for scenes of triangles alone without --kernel: the block-local
/// wavefront; with another --block phase voting where there is one kind of BSDF and no mask, and
/// the loop elsewhere (results/ has the measurements).
MegakernelKind automatic_kernel(const SceneData& scene, const Options& options);

}  // namespace pt
