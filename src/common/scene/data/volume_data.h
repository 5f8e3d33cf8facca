// A grid as loaders and built-in scenes make it.
#pragma once

#include "common/scene/data/scene_data.h"

namespace pt {

/// Values at regular points of the cube [0, 1]^3, which `to_world` takes into the scene.
struct VolumeData {
  std::uint32_t size[3] = {};  ///< voxels along x, y and z, each at least 1
  std::uint32_t channels = 1;  ///< 1 or 3
  bool interpolates = true;    ///< trilinear; else constant in each voxel
  std::vector<float> values;   ///< x varies fastest, then y; channels side by side; finite, >= 0
  Affine to_world;             ///< not singular
};

/// The same in space, with a layer of zeros around it: it fades to nothing beyond its cube.
VolumeData with_rim_of_zeros(const VolumeData& volume);

/// Whether all of the outermost voxels are 0. `values`: of so many voxels, as above.
bool has_empty_rim(const std::uint32_t (&size)[3], std::uint32_t channels, const float* values);

/// Adds the grid to the scene; its index, for a Medium. Throws Error, which names the scene and
/// what was expected, where the grid is not as above.
std::uint32_t add_grid(SceneData& scene, const VolumeData& volume);

}  // namespace pt
