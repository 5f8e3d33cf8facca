// What a render measured. Filled by the renderers, printed and written by report.h.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/options/hardware_counters.h"

namespace pt {

struct StageTime {
  std::string stage;
  double time_ms = 0;          ///< device time on CUDA, wall time on the CPU
  std::uint64_t launches = 0;  ///< kernel launches (CUDA), parallel loops (CPU)
};

/// Why a render has the samples that it has.
enum class RunEnd { samples, time_limit, target_error, interrupted };

/// What the Markov chains of --integrator mlt did (docs/design/metropolis.md).
struct MetropolisStats {
  std::uint64_t chains = 0;
  std::uint64_t mutations = 0;  ///< of all chains
  std::uint64_t bootstrap = 0;  ///< paths before them
  double brightness = 0;        ///< b: the mean luminance of the bootstrap's paths
  double brightness_error = 0;  ///< its standard error
  double large_share = 0;       ///< of the mutations, 0..1
  double large_acceptance = 0;  ///< fraction of large steps that were accepted, 0..1
  double small_acceptance = 0;
  double bootstrap_ms = 0;     ///< of the kernel time: before the first mutation
  double mutations_per_s = 0;  ///< by the time of the mutations alone
};

/// What one of several devices contributed to a render.
struct DeviceShare {
  std::string name;
  std::uint64_t units = 0;
  std::uint64_t samples = 0;  ///< of all pixels
  double kernel_ms = 0;       ///< of its units
  double wall_ms = 0;         ///< the same, with what the host did for them
};

/// One render of the whole image.
struct RenderRun {
  /// From the first stage's start to the last one's end, all batches; of several devices that of
  /// the one that took longest.
  double kernel_ms = 0;
  std::vector<StageTime> stages;
  std::uint64_t waves = 0;  ///< turns of the wavefront's loop; 0 in other modes
  int samples_done = 0;     ///< per pixel; less than asked for where something ended it before
  RunEnd ended_by = RunEnd::samples;
  std::optional<double> relative_error;  ///< of the image (image_error.h), where it was estimated
  std::optional<MetropolisStats> metropolis{};  ///< of --integrator mlt
  std::vector<DeviceShare> devices{};  ///< where there are several; stages: of all together
  double wall_ms = 0;                  ///< of the render on the host
};

/// The render has neither all samples nor reached a stop.
inline bool is_cut_short(const RenderRun& run, int samples) {
  return run.samples_done < samples && run.ended_by != RunEnd::time_limit &&
         run.ended_by != RunEnd::target_error;
}

/// What was traced: equal for every mode, device and --schedule that renders the same image.
struct PathCounts {
  std::uint64_t paths = 0;
  std::uint64_t rays = 0;  ///< closest-hit rays, camera rays included
  std::uint64_t shadow_rays = 0;
  std::uint64_t nonfinite_samples =
      0;  ///< samples with NaN or Inf, counted and left out of the film
  std::vector<std::uint64_t> live_paths;  ///< [k]: paths that traced a k-th ray, k = 0 the camera's
};

struct BufferSize {
  std::string name;
  std::uint64_t size_bytes = 0;
};

struct KernelInfo {
  std::string name;
  int registers = 0;               ///< per thread
  std::uint64_t spill_bytes = 0;   ///< local memory per thread: spills and stack
  std::uint64_t shared_bytes = 0;  ///< per block, static and dynamic
  int block_threads = 0;
  double occupancy = 0;  ///< resident warps / the multiprocessor's warps, 0..1
};

/// How full warps were at a point of the code (lane_counter.h).
struct LaneHistogram {
  std::string point;
  int bounce = 0;  ///< rays that the paths had traced before; the last one stands for more as well
  std::array<std::uint64_t, 32> groups{};  ///< [n - 1]: how often n lanes were there together
};

/// The tree over a scene's triangles.
struct TreeFacts {
  std::string builder;  ///< empty: there is none
  std::uint64_t nodes = 0;
  std::uint64_t references = 0;  ///< triangles in leaves, each as often as it is there
  int depth = 0;
  double sah_cost = 0;            ///< by the surface area heuristic; 0: unknown
  double bytes_per_triangle = 0;  ///< of tree and triangles
  double build_ms = 0;            ///< wall time on the host, kernel time on CUDA
};

/// A choice of the plan, as --explain prints it.
struct Decision {
  std::string option;  ///< sets the choice if given
  std::string value;
  std::string reason;

  bool operator==(const Decision&) const = default;
};

/// What a scene consists of and what its acceleration structure is like.
struct SceneFacts {
  std::uint64_t triangles = 0;  ///< of the meshes, each counted once
  std::uint64_t meshes = 0, instances = 0, spheres = 0, quads = 0;
  std::uint64_t materials = 0, textures = 0;
  std::uint64_t lights = 0;        ///< primitives that emit, delta lights, the environment
  std::vector<BufferSize> memory;  ///< on the host, by kind
  TreeFacts tree;
};

/// Where the wall time of a process went (ms): one after the other, so that the sum is what has
/// passed since it was begun. What follows the statistics is missing: the end of CUDA, freed
/// memory.
struct ProcessTimes {
  double start = 0;    ///< until the command runs, to 10 ms: libraries, options
  double devices = 0;  ///< looking for them, while the scene is read
  double scene = 0;    ///< waiting for the scene to be read
  double prepare = 0;  ///< its plan, trees and lights
  double setup = 0;    ///< waiting for the device's context, buffers, upload
  double render = 0;   ///< all renders, warm-ups, and the loading of kernels
  double image = 0;    ///< download, development, encoding, the file

  double total() const { return start + devices + scene + prepare + setup + render + image; }
};

/// The structures that OptiX has built, with --accel optix.
struct OptixFacts {
  double build_ms = 0;  ///< wall time, with compaction
  std::uint64_t bytes_built = 0, bytes_compacted = 0;
  unsigned rtcore_version = 0;  ///< 0: the device has no RT cores, and traces by software
  bool reorders = false;        ///< with --reorder: the device has reordered threads
};

struct RenderReport {
  std::string device_name;     ///< e.g. "NVIDIA H200" or "CPU, 8 threads"
  std::string device_kind;     ///< "cpu" or "cuda"
  std::string driver;          ///< CUDA driver and runtime versions; empty on the CPU
  std::vector<Decision> plan;  ///< how the render was executed, and why
  std::string calibration;     ///< hash of the one whose numbers the plan used; empty: none
  std::string mode;            ///< used, never "auto"
  std::string accel;           ///< the structure used, e.g. "bvh2"
  std::string schedule;  ///< of --schedule, as used: "host" or "graph"; empty where there is none
  std::string stages;    ///< of --stages, likewise: "split" or "fused"
  std::uint64_t pool_size = 0;     ///< paths in flight used; 0 in modes without a pool
  std::uint32_t finish_paths = 0;  ///< of --finish-paths, as used; 0 in modes without a pool
  std::uint64_t primitives = 0;
  SceneFacts scene;
  std::optional<OptixFacts> optix;
  double scene_ms = 0;     ///< loading and preparing the scene (host wall time)
  double setup_ms = 0;     ///< device initialisation and allocation
  double load_ms = 0;      ///< loading of kernels, before the first render; 0 on the CPU
  double transfer_ms = 0;  ///< scene upload and image download
  double image_write_ms = 0;
  ProcessTimes process_ms;        ///< of this render alone where the process makes several
  std::optional<float> exposure;  ///< stops by which a PNG or PPM was multiplied
  PathCounts counts;
  std::vector<RenderRun> runs;  ///< the measured repeats
  std::vector<BufferSize> memory;
  std::vector<KernelInfo> kernels;
  std::optional<HardwareCounters> counters;  ///< where they were asked for
  std::vector<LaneHistogram> divergence;     ///< of the last render, where the build counts lanes
};

}  // namespace pt
