// A cumulus cloud on a grid of any size.
#pragma once

#include "common/scene/builtin/scene_name.h"
#include "common/scene/data/scene_data.h"
#include "common/scene/data/volume_data.h"

namespace pt {

struct CloudSettings {
  std::uint32_t side = 128;  ///< N: voxels along each axis, from 2 to cloud_side_most
  float optical_depth = 10;  ///< T > 0: of the densest column of voxels along z
  float albedo = 0.999f;     ///< A in [0, 1]
};
inline constexpr std::uint32_t cloud_side_most = 1024;

/// Reads cloud:N:T:A, of which the last parts may be left out. Throws Error that names the part.
CloudSettings parse_cloud(const SceneName& scene);

/// Densities in [0, 1] in the cube [-1, 1]^3; the same bits for any number of threads. The shape
/// does not depend on the side, but for the finest octaves, which a coarse grid cannot show.
VolumeData generate_cloud(std::uint32_t side);

/// The cloud above a ground, under a blue sky and a sun. Its phase function is Henyey and
/// Greenstein's with a mean cosine of 0.8.
SceneData make_cloud_scene(const CloudSettings& settings);

}  // namespace pt
