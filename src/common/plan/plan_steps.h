// What planning consists of: what cannot be had (plan_rules.cpp), and what a tree over triangles is
// expected to cost, built and traced, by which --builder auto chooses (tree_times.cpp).
#pragma once

#include <vector>

#include "common/plan/execution_plan.h"
#include "common/plan/kernels.h"

namespace pt {

/// The device as the limits let a plan see it. Throws Error for more than there is.
DeviceProperties limit_device(DeviceProperties device, const DeviceLimits& limits);

/// Before anything is chosen. Throws Error.
void check_options_for_scene(const Options& options, const SceneProperties& scene);

/// Whether CUDA's kernels of a scene look up sparse grids. The call takes registers, so kernels of
/// dense grids do not where nothing moves.
inline bool looks_up_sparse_grids(const SceneProperties& scene) {
  return scene.has_sparse || (scene.has_motion && scene.has_masked_kernels());
}

/// Which kernel a plan asks for; `on_cuda`: the device renders it, not a thread of the host.
KernelNeed need_of(const ExecutionPlan& plan, const Options& options, const SceneProperties& scene,
                   bool on_cuda);

/// What was chosen, with the options. Throws Error.
void check_plan(const ExecutionPlan& plan, const Options& options, const SceneProperties& scene,
                const DeviceProperties& device);

/// What a scene that moves cannot be had with. Throws Error.
void check_motion(const Options& options, const SceneProperties& scene,
                  const DeviceProperties& device);

/// What --accel optix cannot be had with. Throws Error.
void check_optix(const Options& options, const SceneProperties& scene,
                 const DeviceProperties& device, const ExecutionPlan& plan);

/// How much there is to build and to trace.
struct TreeWork {
  double triangles = 0;
  double groups = 1;  ///< of meshes; each has a tree of its own
  double rays = 0;    ///< shadow rays included
};

/// Seconds, as expected.
struct TreeTimes {
  TreeBuilder builder = TreeBuilder::best;
  double build_s = 0;
  double trace_s = 0;  ///< all of the rendering, which tracing dominates

  double total_s() const { return build_s + trace_s; }
};

/// Rays of an image of `spp` samples, shadow rays included: an estimate, since nobody knows how
/// many paths leave the scene. As many pixels as are rendered.
double expected_rays(double pixels, const ImageSettings& image, const PlanConstants& c = {});

/// Seconds of so many rays on threads of a CPU.
double expected_cpu_trace_s(double rays, int threads, const PlanConstants& c = {});

/// What each builder that --builder auto may take is expected to cost. `limit_s`: the rendering
/// ends then, 0: it does not. The rates (PlanConstants; results/log/2026-11-whole-process.md) are
/// scaled by a device's multiprocessors or threads; they are to choose by, not to plan a day with.
std::vector<TreeTimes> expected_tree_times(const TreeWork& work, const DeviceProperties& device,
                                           double limit_s);

/// What building took on the host; of `splits`: by sbvh.
struct BuilderSeconds {
  double sah = 0, sah_reinsert = 0, splits = 0;
};

/// Gives the constants of the host's builders the values by which these times are expected.
void fit_builders(PlanConstants& constants, double triangles, int threads,
                  const BuilderSeconds& seconds);

}  // namespace pt
