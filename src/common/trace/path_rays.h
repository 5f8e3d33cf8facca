// The rays that a scene's own paths trace.
#pragma once

#include "common/scene/scene_data.h"
#include "common/trace/ray_file.h"

namespace pt {

/// The rays of paths after `bounce` bounces at the scene's surfaces (0: the camera rays), by pixels
/// in Morton order of an image of `size` x `size`, a power of two. Paths that end before are left
/// out; further samples fill their places until there are size^2 rays, or 64 samples of each pixel
/// have been taken. `scene` is prepared. Throws Error where no path lives so long.
RaySet generate_path_rays(const SceneData& scene, int bounce, int size);

}  // namespace pt
