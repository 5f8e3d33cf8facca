// Grids as loaders and built-in scenes describe them.
#pragma once

#include "common/scene/data/scene_data.h"

namespace pt {

/// Values at regular points of the cube [0, 1]^3, which `to_world` maps into the scene.
struct VolumeData {
  std::uint32_t size[3] = {};  ///< voxels along x, y and z, each at least 1
  std::uint32_t channels = 1;  ///< 1 or 3
  bool interpolates = true;    ///< trilinear; else constant in each voxel
  std::vector<float> values;   ///< x varies fastest, then y; channels side by side; finite, >= 0
  Affine to_world;             ///< not singular
};

/// The same grid with a layer of zeros around it, so that it fades out at its cube.
VolumeData with_rim_of_zeros(const VolumeData& volume);

/// Whether all of the outermost voxels are 0. `values` as in VolumeData.
bool has_empty_rim(const std::uint32_t (&size)[3], std::uint32_t channels, const float* values);

/// Adds the grid to the scene and returns its index, for a Medium. Throws Error if the grid
/// violates VolumeData.
std::uint32_t add_grid(SceneData& scene, const VolumeData& volume);

}  // namespace pt
