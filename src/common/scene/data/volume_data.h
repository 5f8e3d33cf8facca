// Grids as loaders and built-in scenes describe them: arrays of voxels, or trees of NanoVDB.
#pragma once

#include <atomic>
#include <functional>
#include <span>

#include "common/choices/choices.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// Values at regular points of the cube [0, 1]^3, which `to_world` maps into the scene.
struct VolumeData {
  std::uint32_t size[3] = {};  ///< voxels along x, y and z, each at least 1
  std::uint32_t channels = 1;  ///< 1 or 3
  bool interpolates = true;    ///< trilinear; else constant in each voxel
  std::vector<float> values;   ///< x varies fastest, then y; channels side by side; finite, >= 0
  Affine to_world;             ///< not singular
  // A sparse grid has a tree instead of values (medium/sparse_tree_nanovdb.h). Its outermost voxels
  // are 0.
  std::vector<SparseBlock> nodes;
  std::uint32_t root = 0;    ///< index of the block where the tree's root begins; that before it is
                             ///< for its SparseHead
  std::int32_t low[3] = {};  ///< the tree's coordinates of voxel (0, 0, 0)
  std::vector<float> colors;  ///< of a sparse grid of 3 channels, the first of what is empty

  bool is_sparse() const { return !nodes.empty(); }
};

/// Makes room for a layer of voxels around the grid. Its values stay as they are.
void widen_by_rim(VolumeData& volume);

/// The same dense grid with a layer of zeros around it, so that it fades out at its cube.
VolumeData with_rim_of_zeros(const VolumeData& volume);

/// Whether all of the outermost voxels are 0. `values` as in VolumeData.
bool has_empty_rim(const std::uint32_t (&size)[3], std::uint32_t channels, const float* values);

/// Adds the grid to the scene and returns its index, for a Medium. Grids of equal voxels share them
/// in memory. Throws Error if the grid violates VolumeData.
std::uint32_t add_grid(SceneData& scene, VolumeData volume);

/// The largest of the grid's values.
float largest_value(const VolumeData& volume);

// Sparse grids.

/// A cube of a tree's voxels, which has its values or one value.
struct SparseBrick {
  glm::ivec3 low;       ///< in the tree's coordinates
  int side;             ///< in voxels
  const float* values;  ///< of a brick of 8^3 voxels, z varies fastest; null: `value`
  float value;
};

/// Calls function(brick) for all bricks that are not 0, which may be at the same time.
void for_each_brick(const SparseBlock* root,
                    const std::function<void(const SparseBrick&)>& function);

/// The larger of both, where other threads may raise the number as well.
inline void raise_to(std::atomic_ref<float> number, float value) {
  float known = number;
  while (known < value && !number.compare_exchange_weak(known, value)) {
  }
}

/// A sparse grid as an array of voxels. Throws Error where that is too large.
VolumeData dense_copy(const VolumeData& volume);

/// A sparse grid as the user wants it: automatic decides by the memory that each takes.
VolumeData stored_as(VolumeStorage storage, VolumeData volume);

/// Makes the voxels of a sparse grid of floats numbers, of their values in the order of the result,
/// which begins with a 0. False, and nothing is done: its values are quantized.
bool number_voxels(VolumeData& volume, std::vector<float>& values);

/// A sparse grid of `side`^3 voxels. The bricks of 8^3 voxels at `places` (multiples of 8, sorted
/// by x, y and z, no two the same) have the values that fill(index of the place, values) writes,
/// which may be called at the same time; z varies fastest. Its outermost voxels have to be 0.
/// Throws Error in a program without NanoVDB.
VolumeData make_sparse(std::uint32_t side, std::span<const glm::ivec3> places,
                       const std::function<void(std::size_t, float*)>& fill);

}  // namespace pt
