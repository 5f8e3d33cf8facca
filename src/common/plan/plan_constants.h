// The numbers that the plan decides by and that differ from device to device: all that was fitted
// to measurements. The defaults are those of an H200 and of its host of 16 cores
// (results/README.md, results/log/); `ptexp calibrate` measures some of them on another device.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <iterator>
#include <string>

namespace pt {

struct PlanConstants {
  // Where a choice turns: the largest number for which the first of two ways is the faster one.
  double scan_primitives = 96;           ///< scanned faster than a tree is walked: of any kind
  double scan_spheres_wavefront = 384;   ///< the same of spheres alone on CUDA, in half precision.
  double scan_spheres_megakernel = 224;  ///< A stage waits for the slowest ray of its warp.
  /// Spheres in constant memory. The scan's first two chunks are addressed by constants
  /// (traverse_brute.h); beyond, 250 spheres take 5 % longer than in global memory, 1000 45 %.
  double constant_spheres = 64;
  /// Emitters: on a GPU the descents of a light tree can take as long as all other shading. No
  /// calibration has it, since the image depends on it.
  double few_emitters = 16;
  double order_kinds = 5;          ///< kinds of BSDFs whose surfaces are not ordered
  double short_depth = 6;          ///< rays of a path among quads: waves trace them in full warps
  double short_depth_sorting = 6;  ///< the same against blocks that sort
  /// Long paths among quads, for each multiprocessor: a megakernel waits for the longest.
  double few_paths_multiprocessor = (1 << 19) / 132.0;

  // Times of the megakernel by those of the wavefront: median over results/nvidia-h200/sizes.csv.
  double megakernel_spheres = 0.84;
  double megakernel_sorting = 0.83;  ///< --kernel sort, many kinds of BSDFs on long paths
  double megakernel_mesh = 1.08;     ///< other scenes
  double megakernel_cpu = 1.8;       ///< any scene: mean of docs/tutorial.md

  // Paths that are finished together, by what follows them, and paths in flight.
  double finish_lean = 1 << 17;       ///< threads, among spheres and quads alone
  double finish_blocks = 1 << 20;     ///< block-local wavefronts; about as many as they hold
  double finish_plain = 1 << 15;      ///< threads, elsewhere
  double finish_expensive = 1 << 13;  ///< threads, with instances or many kinds of BSDFs
  /// Where a pass over all tags fills the queues: it hides the launches and fits the L2 cache.
  double pool_passes = 1 << 20;
  double pool_thread = 1024;  ///< of each thread of a CPU

  // Seconds of a ray, shading included.
  double ray_s_thread = 0.9e-6;
  double ray_s_multiprocessor = 52.8e-9;

  // A thread's seconds for a million triangles, of which a part is done by one thread alone. At
  // most so many triangles' worth of nodes is reinserted; spatial splits are tried by `best` where
  // siblings overlap, in about one scene of three.
  double host_start_s = 2e-3;
  double sah_s = 1.0, sah_alone = 0.07;
  double reinsert_s = 0.6, reinsert_alone = 0.2, reinsert_triangles = 0.33e6;
  double splits_s = 3.5, splits_tried = 0.35;
  double upload_triangle_s = 1e-8;
  // Time of rendering by that with `sah`.
  double reinserted_trace = 0.98, best_trace = 0.97;

  // A builder on a GPU: kernels that are loaded at their first use, launches for each group's tree,
  // and what a triangle takes with the upload of its mesh.
  double hploc_start_s = 6e-3, hploc_group_s = 2.5e-3, hploc_triangle_s = 2.5e-9;
  double hploc_trace = 1.01;
  double hploc_reinsert_start_s = 7e-3, hploc_reinsert_group_s = 4e-3;
  double hploc_reinsert_triangle_s = 7.5e-9, hploc_reinsert_trace = 0.98;

  // Of scenes: guesses, since nobody knows how many paths leave one.
  double rays_of_path = 4;  ///< at most, before most have left or are absorbed
  double shadow_rays_of_ray = 0.6;

  std::uint64_t measured = 0;  ///< a bit for each line of plan_constant_table
  std::string measured_on;     ///< those: the device's name, or empty: on this one
  std::string calibration;     ///< hash of the file that they are from; empty: none

  bool operator==(const PlanConstants&) const = default;
};

using PlanConstant = double PlanConstants::*;

/// As a file of `ptexp calibrate` has it.
struct PlanConstantInfo {
  const char* name;
  PlanConstant value;
  const char* unit;
  double lowest, highest;  ///< that can be meant
};

inline constexpr PlanConstantInfo plan_constant_table[] = {
    {"scan_primitives", &PlanConstants::scan_primitives, "primitives", 0, 1e6},
    {"scan_spheres_wavefront", &PlanConstants::scan_spheres_wavefront, "spheres", 0, 1e6},
    {"scan_spheres_megakernel", &PlanConstants::scan_spheres_megakernel, "spheres", 0, 1e6},
    {"constant_spheres", &PlanConstants::constant_spheres, "spheres", 0, 1024},
    {"order_kinds", &PlanConstants::order_kinds, "kinds", 0, 64},
    {"short_depth", &PlanConstants::short_depth, "rays", 0, 65535},
    {"short_depth_sorting", &PlanConstants::short_depth_sorting, "rays", 0, 65535},
    {"few_paths_multiprocessor", &PlanConstants::few_paths_multiprocessor, "paths", 0, 1e12},
    {"megakernel_spheres", &PlanConstants::megakernel_spheres, "times", 0.001, 1000},
    {"megakernel_sorting", &PlanConstants::megakernel_sorting, "times", 0.001, 1000},
    {"megakernel_mesh", &PlanConstants::megakernel_mesh, "times", 0.001, 1000},
    {"megakernel_cpu", &PlanConstants::megakernel_cpu, "times", 0.001, 1000},
    {"finish_lean", &PlanConstants::finish_lean, "paths", 0, 1 << 30},
    {"finish_blocks", &PlanConstants::finish_blocks, "paths", 0, 1 << 30},
    {"finish_plain", &PlanConstants::finish_plain, "paths", 0, 1 << 30},
    {"finish_expensive", &PlanConstants::finish_expensive, "paths", 0, 1 << 30},
    {"pool_passes", &PlanConstants::pool_passes, "paths", 1, 1 << 30},
    {"pool_thread", &PlanConstants::pool_thread, "paths", 1, 1 << 20},
    {"ray_s_thread", &PlanConstants::ray_s_thread, "s", 1e-12, 1},
    {"ray_s_multiprocessor", &PlanConstants::ray_s_multiprocessor, "s", 1e-12, 1},
    {"host_start_s", &PlanConstants::host_start_s, "s", 0, 100},
    {"sah_s", &PlanConstants::sah_s, "s", 1e-6, 1000},
    {"sah_alone", &PlanConstants::sah_alone, "share", 0, 1},
    {"reinsert_s", &PlanConstants::reinsert_s, "s", 1e-6, 1000},
    {"reinsert_alone", &PlanConstants::reinsert_alone, "share", 0, 1},
    {"reinsert_triangles", &PlanConstants::reinsert_triangles, "triangles", 1, 1e12},
    {"splits_s", &PlanConstants::splits_s, "s", 1e-6, 1000},
    {"splits_tried", &PlanConstants::splits_tried, "share", 0, 1},
    {"upload_triangle_s", &PlanConstants::upload_triangle_s, "s", 0, 1},
    {"reinserted_trace", &PlanConstants::reinserted_trace, "times", 0.1, 10},
    {"best_trace", &PlanConstants::best_trace, "times", 0.1, 10},
    {"hploc_start_s", &PlanConstants::hploc_start_s, "s", 0, 100},
    {"hploc_group_s", &PlanConstants::hploc_group_s, "s", 0, 100},
    {"hploc_triangle_s", &PlanConstants::hploc_triangle_s, "s", 1e-13, 1},
    {"hploc_trace", &PlanConstants::hploc_trace, "times", 0.1, 10},
    {"hploc_reinsert_start_s", &PlanConstants::hploc_reinsert_start_s, "s", 0, 100},
    {"hploc_reinsert_group_s", &PlanConstants::hploc_reinsert_group_s, "s", 0, 100},
    {"hploc_reinsert_triangle_s", &PlanConstants::hploc_reinsert_triangle_s, "s", 1e-13, 1},
    {"hploc_reinsert_trace", &PlanConstants::hploc_reinsert_trace, "times", 0.1, 10},
    {"rays_of_path", &PlanConstants::rays_of_path, "rays", 1, 65535},
    {"shadow_rays_of_ray", &PlanConstants::shadow_rays_of_ray, "rays", 0, 100}};
static_assert(std::size(plan_constant_table) < 64);

/// Gives a constant of the table a measured value.
void set_measured(PlanConstants& constants, PlanConstant constant, double value);

bool is_measured(const PlanConstants& constants, PlanConstant constant);

/// Where the constants come from that a decision rests on: "measured here", "measured on NAME",
/// "from an H200", or, of several, "partly ...".
std::string origin_of(const PlanConstants& constants, std::initializer_list<PlanConstant> used);

}  // namespace pt
