// Everything a user can choose, with the defaults of `ptexp`. Plain data; parsing is
// command_line.h.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/choices/accel.h"
#include "common/choices/choices.h"
#include "common/choices/optix_hits.h"
#include "common/options/compaction_info.h"
#include "common/options/stage_info.h"

namespace pt {

enum class Mode { automatic, serial, megakernel, wavefront };
enum class Work { pixel, sample, persistent };
enum class KernelSet { automatic, specialized, general };
enum class MegakernelKind { automatic, loop, vote, sort };
enum class Schedule { automatic, host, graph };
enum class PoolLayout { soa, sectors, aos };
enum class SurfaceOrdering { automatic, on, off };
enum class Stages { automatic, split, fused };
enum class SceneMemory { automatic, global, shared, constant };
enum class IntegratorKind { path, mlt };
enum class Branching { divergent, reduced };
enum class RngKind { philox, xorwow };
/// `best`: by sah_reinsert or sbvh, whichever rays on trial find cheaper.
enum class TreeBuilder { automatic, sah, sah_reinsert, sbvh, best, lbvh, hploc, hploc_reinsert };
enum class LightSelection { automatic, uniform, power, tree };
enum class WorldBuilder { host, device };
enum class DefaultLighting { automatic, on, off };

using StageBlocks = std::array<int, stage_count>;  ///< threads per block, by StageId
/// Measured on an H200 (results/). Shading, the stage with most code, gains by large blocks, whose
/// warps fetch the same instructions at about the same time.
constexpr StageBlocks default_stage_blocks() {
  StageBlocks blocks{};
  for (int& block : blocks) block = 256;
  blocks[static_cast<std::size_t>(StageId::shade_surface)] = 640;
  return blocks;
}

struct DeviceChoice {
  enum class Kind { automatic, cpu, cuda } kind = Kind::automatic;
  int index = 0;            ///< CUDA device ordinal
  std::vector<int> more{};  ///< ordinals of further devices; of the CPU: a number for each
  bool wants_all = false;   ///< every CUDA device that there is

  int count() const { return 1 + static_cast<int>(more.size()); }
  bool has_several() const { return wants_all || !more.empty(); }
};

/// One of `count` disjoint parts of an image's pixels, which together are all of them.
struct PartChoice {
  int index = 1;  ///< from 1
  int count = 1;

  bool operator==(const PartChoice&) const = default;
};

/// Where a render's film is saved, and how often.
struct CheckpointChoice {
  std::string file;  ///< empty: nowhere
  float interval_s = 300.0f;
};

struct BlockSize {
  int x = 16;
  int y = 16;

  std::int64_t threads() const { return std::int64_t{x} * y; }
  bool operator==(const BlockSize&) const = default;
};

/// How bright a PNG or PPM is.
struct ExposureChoice {
  /// `scene`: measured in a PNG where SceneDefaults::measure_exposure, else 0 stops.
  enum class Kind { scene, measured, fixed } kind = Kind::scene;
  float stops = 0.0f;  ///< of Kind::fixed
};

/// Overrides of the scene's own camera; absent values keep the scene's.
/// Lengths in scene units, `vertical_fov_degrees` in (0, 180), `aperture` is the lens diameter.
struct CameraOverrides {
  std::optional<std::array<float, 3>> look_from, look_at, up;
  std::optional<float> vertical_fov_degrees, aperture, focus_distance;
};

/// How samples become pixels (scene/prepare/prepare_filter.h).
enum class FilterKind { box, tent, gaussian, mitchell, lanczos };

/// A reconstruction filter, centred on the pixel and separable; lengths in pixels.
struct FilterChoice {
  FilterKind kind = FilterKind::box;
  float a = 0.5f;  ///< box, tent: radius; gaussian: standard deviation; mitchell: B; lanczos: lobes
  float b = 0.0f;  ///< mitchell: C

  bool operator==(const FilterChoice&) const = default;
};

/// Pixels [x0, x1) x [y0, y1) of the image.
struct CropWindow {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  bool operator==(const CropWindow&) const = default;
};

/// What is computed: with the scene, these settings determine the image.
struct ImageSettings {
  int width = 600;   ///< pixels, 1..65535
  int height = 300;  ///< pixels, 1..65535
  IntegratorKind integrator = IntegratorKind::path;
  int spp = 50;        ///< samples per pixel, >= 1
  int max_depth = 50;  ///< rays per path, camera ray included, 1..65535
  int rr_depth = 0;    ///< rays after which Russian roulette begins, 0: never
  bool nee = true;     ///< next-event estimation: light sampling
  DirectionSampling sampling = DirectionSampling::bsdf;
  MisHeuristic mis = MisHeuristic::power;
  SamplerKind sampler = SamplerKind::independent;
  RngKind rng = RngKind::philox;
  std::uint64_t seed = 1;
  std::optional<CropWindow> crop;  ///< none: the scene file's, or the whole image
  std::uint32_t aovs = 0;          ///< a bit for each layer of aov.h, in its order

  // Stops: the render ends with the first of them that is reached
  float time_limit = 0.0f;    ///< seconds of rendering, 0: none
  float target_error = 0.0f;  ///< relative standard error of the image (image_error.h), 0: none

  // Only for IntegratorKind::mlt (docs/design/metropolis.md)
  std::uint64_t chains = 0;              ///< Markov chains, 0: automatic
  float large_step_probability = 0.05f;  ///< in (0, 1]
  float mutation_size = 0.00390625f;     ///< largest small step of a number, in (0, 1/2]
  std::uint64_t bootstrap = 0;           ///< paths before the chains, 0: automatic
};

/// A smaller device than the one that is there, for experiments (CUDA).
struct DeviceLimits {
  int sms = 0;                ///< multiprocessors, 0: all
  int shared_memory_max = 0;  ///< KiB of shared memory that a block may have, 0: the device's own

  bool operator==(const DeviceLimits&) const = default;
};

/// How it is executed, as far as the user alone decides: the plan takes these settings over. They
/// do not change the image.
struct ExecutionSettings {
  int threads = 0;  ///< CPU threads, 0: all
  DeviceLimits limits;
  TreeBuilder builder = TreeBuilder::automatic;  ///< builds trees over triangles
  OptixHits optix_hits = OptixHits::custom;      ///< with AccelKind::optix
  bool reorder = false;                          ///< likewise, megakernel: threads by their hits
  Work work = Work::persistent;                  ///< megakernel
  BlockSize block;                               ///< megakernel, threads per block
  Branching branching = Branching::divergent;
  Compaction compaction = Compaction::atomic;
  std::uint64_t pool_size = 0;              ///< paths in flight, 0: automatic
  PoolLayout layout = PoolLayout::sectors;  ///< wavefront: layout of the paths' state
  bool regenerate = true;
  int wave_collisions = 0;  ///< Stages::split: null collisions of a flight in a wave, 0: all
  int wave_rays = 2;        ///< Stages::fused: rays of a path in a wave, 1..65535
  StageBlocks stage_block = default_stage_blocks();
  /// Pools and samples take no more than the free memory / 2^this. Not an option of the command
  /// line: a device that has run out of memory is tried again with less.
  int memory_halvings = 0;
  int path_bytes = 0;  ///< more state of each path, a multiple of path_bytes_step
};

/// Everything that a user chooses.
struct Options : ImageSettings, ExecutionSettings {
  // Left to the plan where automatic (plan/execution_plan.h)
  Mode mode = Mode::automatic;
  DeviceChoice device;
  AccelKind accel = AccelKind::automatic;
  KernelSet kernel_set = KernelSet::automatic;        ///< those of the paper's scenes, or of all
  MegakernelKind kernel = MegakernelKind::automatic;  ///< megakernel on CUDA
  SceneMemory scene_memory = SceneMemory::automatic;  ///< constant for few spheres
  LightSelection light_selection = LightSelection::automatic;
  Stages stages = Stages::automatic;  ///< wavefront: whether one kernel traces and shades
  SurfaceOrdering order_surfaces = SurfaceOrdering::automatic;  ///< wavefront: by kind of BSDF
  bool persistent = true;  ///< warps trace queues where they can (CUDA)
  /// The last paths, so many, are followed to their ends at once, 0: none; absent: automatic.
  std::optional<std::uint32_t> finish_paths;
  Schedule schedule = Schedule::automatic;  ///< graph on CUDA, host on the CPU

  // Scene
  std::string scene = "spheres";
  int spheres = 50;  ///< random spheres of the scene `spheres`, besides the ground, >= 0
  WorldBuilder create_world = WorldBuilder::host;
  std::map<std::string, std::string> definitions;  ///< of a scene file's parameters
  bool strict = false;  ///< what a scene file has and ptexp lacks is an error
  DefaultLighting default_lighting = DefaultLighting::automatic;  ///< of scene files
  VolumeStorage volume = VolumeStorage::automatic;                ///< of sparse grids
  std::optional<float> time;  ///< of a scene file's animations, seconds; none: ignored
  std::optional<float>
      shutter;            ///< seconds from `time` on while it is open; none: it moves nothing
  std::string animation;  ///< its name or number; empty: all that do not conflict
  bool scene_from_disk = false;  ///< of a job's ranks: each reads the scene's files by itself
  CameraOverrides camera;
  std::optional<FilterChoice> filter;  ///< none: the scene file's, or a box of one pixel
  bool multiple_scattering = false;    ///< of rough conductors, between their facets

  // Output
  std::string output = "image.exr";  ///< .exr, .png or .ppm
  ExposureChoice exposure;           ///< for PNG and PPM only
  CheckpointChoice checkpoint;
  PartChoice part;  ///< what is rendered; the rest is left to others

  // Measurement
  int repeat = 1;          ///< measured renders, >= 1
  int warmup = 0;          ///< unmeasured renders before them, >= 0
  bool counters = false;   ///< read the hardware's counters, in renders of their own
  std::string stats_file;  ///< JSON, empty: none
  std::string csv_file;    ///< appended, empty: none
  bool explain = false;    ///< print the plan and exit
  /// "auto": what `ptexp calibrate` has stored for the device; "none", or a file.
  std::string calibration = "auto";
  bool quiet = false;
};

}  // namespace pt
