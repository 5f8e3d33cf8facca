// What a render's plan depends on besides the options: plain facts of the scene and the device.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "common/choices/accel.h"
#include "common/options/options.h"
#include "common/plan/plan_constants.h"

namespace pt {

struct SceneProperties {
  std::string name;
  std::size_t spheres = 0, quads = 0;
  std::size_t triangles = 0;  ///< of the meshes
  std::size_t instances = 0;
  std::size_t tree_groups = 1;       ///< of meshes; each gets a tree
  bool is_primitive_only = false;    ///< nothing that the paper's scenes have not
  bool has_motion = false;           ///< something moves while the shutter is open
  bool has_moving_surfaces = false;  ///< not the camera alone
  bool deforms = false;              ///< meshes do
  bool has_masks = false;            ///< triangles that not all rays meet
  bool has_media = false;            ///< between surfaces
  bool has_sparse = false;           ///< grids of media
  bool has_open_boundaries = false;  ///< surfaces may let light through
  bool has_emitters = false;         ///< surfaces that shine
  bool has_moving_grids = false;     ///< surfaces that move bound a medium with a grid
  bool has_rough_conductors = false;
  std::uint32_t bsdf_kinds = 0;  ///< a bit for each MaterialKind that a surface has
  std::size_t emitters = 0;      ///< lights that can be sampled
  std::size_t scan_bytes = 0;    ///< size of the spheres that CUDA scans
  // Known once the scene has been built:
  std::optional<Accel> structure;
  std::string why_structure;  ///< as the plan said
  std::optional<TreeBuilder> builder;

  bool has_masked_kernels() const { return has_masks || has_media; }
  bool has_only_triangles() const { return spheres == 0 && instances == 0; }
  /// No instances, or some that warps trace in wide trees.
  bool has_plain_instances() const { return instances == 0 || (!has_masks && !has_media); }
};

struct DeviceProperties {
  bool is_cuda = false;
  int host_threads = 1;  ///< build what the host builds
  // CPU:
  bool has_avx2 = false;        ///< wide trees are traced by vectors
  bool has_ray_blocks = false;  ///< brute force scans for blocks of rays
  int threads = 1;
  // CUDA device:
  std::size_t block_shared_bytes = 227 * 1024;  ///< most shared memory of a block
  int block_threads_max = 1024;
  int multiprocessors = 132;
  bool can_reorder = false;   ///< threads, where OptiX is asked to: RTX GPUs, from Ada on
  PlanConstants constants{};  ///< an H200's, or those of a calibration
};

/// This machine's processor.
DeviceProperties cpu_properties(int threads);

}  // namespace pt
