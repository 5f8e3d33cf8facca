// What the wavefront's automatic choices assume of a scene: which paths are dear to follow alone,
// and where surfaces are shaded faster in order. Measured on an H200 (results/).
#pragma once

#include <cstdint>

#include "common/render/options.h"
#include "common/scene/scene_data.h"

namespace pt {

/// Whether the surfaces of scenes with these kinds of BSDFs (a bit for each, kinds_of()) are shaded
/// faster in order: where warps would meet many, or one that is much longer than the others.
/// Kernels for each kind give no more.
bool order_pays_for(std::uint32_t kinds);

/// --finish-paths, or by what a path costs: how many may be left when waves end and a thread
/// follows each to its end. A wave costs some 0.1 ms however few rays it has; a thread that follows
/// a path waits for the slowest of its warp, in each ray and in shading of several kinds. So the
/// more the rays of a scene and its kinds of BSDFs differ, the fewer paths are finished that way.
std::uint32_t finish_paths_of(const Options& options, const SceneData& scene);

}  // namespace pt
