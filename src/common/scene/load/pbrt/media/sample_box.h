// A box of regular samples, as pbrt's grids have them.
#pragma once

#include "common/scene/data/volume_data.h"
#include "common/scene/load/pbrt/description/description.h"

namespace pt::pbrt {

/// p0 to p1 in the space of a medium, filled with voxels; a sample lies in the middle of each.
struct SampleBox {
  std::uint32_t size[3] = {1, 1, 1};
  Vec3 low, high;   ///< in the medium's space
  Affine to_world;  ///< of the medium's space

  std::size_t voxels() const { return std::size_t{size[0]} * size[1] * size[2]; }

  /// Of the middle of a voxel, in the medium's space.
  Vec3 center(std::uint32_t i, std::uint32_t j, std::uint32_t k) const;
};

/// The place of the medium's samples, of which there is one. Throws Error for a box without volume.
SampleBox read_box(const Entity& entity);

/// The same with nx * ny * nz samples.
SampleBox read_sample_box(const Entity& entity);

/// The values of colours side by side, or with one channel their reds.
std::vector<float> channels_of(const std::vector<Color>& colors, std::uint32_t channels);

/// For all channels of a voxel, x fastest: how pbrt looks samples up. Beyond the outermost of them
/// they fade to zero, which a layer of zeros around the box says.
VolumeData faded_volume(const SampleBox& box, std::uint32_t channels,
                        const std::vector<float>& values);

/// The same, but the outermost samples go on beyond the box.
VolumeData plain_volume(const SampleBox& box, std::uint32_t channels, std::vector<float> values);

}  // namespace pt::pbrt
