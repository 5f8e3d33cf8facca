// What is computed and how: every choice that options leave open, made in one place by a pure
// function of the options, the scene and the device. Preparation and renderers obey the plan and
// see no options; --explain prints it.
#pragma once

#include <string>
#include <vector>

#include "common/options/options.h"
#include "common/options/stats.h"
#include "common/plan/render_properties.h"

namespace pt {

/// Nothing here is automatic but what ExecutionSettings leave to builder and memory.
struct ExecutionPlan : ImageSettings, ExecutionSettings {
  Mode mode = Mode::wavefront;
  KernelSet kernel_set = KernelSet::general;
  Accel accel = Accel::brute;      ///< what the scene is built as
  Accel traversal = Accel::brute;  ///< the code that traces it
  std::string why_accel;
  bool traces_by_optix = false;  ///< OptiX traces the wavefront's queues, or runs the megakernel
  LightSelection light_selection = LightSelection::uniform;
  MegakernelKind megakernel = MegakernelKind::loop;
  SceneMemory scene_memory = SceneMemory::global;
  bool fused = false;             ///< wavefront: Stages::fused
  bool orders_surfaces = false;   ///< wavefront: the queue of surfaces is sorted by BSDF type
  bool persistent_warps = false;  ///< wavefront: they trace its queues
  std::uint32_t finish_paths = 0;
  bool finishes_in_blocks = false;   ///< wavefront: block-local wavefronts follow them, not threads
  std::uint64_t pool_paths_max = 0;  ///< wavefront: of an automatic pool, 0: no limit
  bool uses_graph = false;           ///< wavefront on CUDA: the device loops over the waves
  std::vector<Decision> decisions;   ///< in the order in which they were made
  std::string calibration;           ///< whose numbers decided (PlanConstants); empty: none
};

/// Why what moves in a scene is not blurred, and what would be; empty: it is.
std::string motion_obstacle(const Options& options, const SceneProperties& scene, bool on_cuda);

/// Made before the scene's acceleration structure is built; for a scene that has one
/// (SceneProperties::structure) that one is kept. Throws Error where the scene or the device cannot
/// have what the options ask for.
ExecutionPlan plan_execution(const Options& options, const SceneProperties& scene,
                             const DeviceProperties& device);

/// Whether the surfaces of scenes with these kinds of BSDFs (SceneProperties) are shaded faster in
/// order: where warps would meet more than `few`, or one that is much longer than the others.
/// Kernels for each kind give no more (results/log/2026-11-material-cost.md).
bool order_pays_for(std::uint32_t bsdf_kinds, double few);

/// Whether trees are built and rays traced by a CUDA device.
inline bool is_on_cuda(const Options& options) {
  return options.device.kind == DeviceChoice::Kind::cuda && options.mode != Mode::serial;
}

/// Whether one of the paper's toggles is on that have kernels of their own; on CUDA these are for
/// scenes that brute force scans.
inline bool is_toggled(const Options& options) {
  return options.rng != RngKind::philox || options.branching != Branching::divergent;
}

/// Why the lean kernels of the paper's scenes cannot render it as the options say; empty: they can.
std::string why_general(const Options& options, const SceneProperties& scene);

/// A line for each decision.
std::string plan_text(const std::vector<Decision>& decisions);

// Limits of kernels that the plan knows, and the kernels assert.

/// More threads in a block would leave too few registers to warps that vote on their phase.
inline constexpr int phase_voting_threads_max = 256;
/// The shared memory that these need.
constexpr std::size_t phase_voting_bytes(std::int64_t threads, int path_bytes) {
  return 2048 + static_cast<std::size_t>(threads) * (200 + static_cast<std::size_t>(path_bytes));
}
/// Shared memory that a block-local wavefront needs at least, with instances: no device has room
/// for less of it alone.
inline constexpr std::size_t sorting_bytes_min = 91 * 1024;
/// A kernel's parameters may take 32,764 bytes (CUDA 12.1 and later, compute capability 7.0); half
/// of it is enough for the paper's scenes and keeps launches short.
inline constexpr std::uint32_t constant_spheres_max = 1024;

}  // namespace pt
