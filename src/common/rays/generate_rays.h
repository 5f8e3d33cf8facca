// Makes sets of rays to measure traversal with.
#pragma once

#include "common/rays/ray_file.h"
#include "common/scene/data/scene_data.h"

namespace pt {

enum class RayKind {
  primary,  ///< through the pixels' centres, in Morton order; closest hit
  ao,       ///< eight cosine-distributed rays where each primary one hits; any hit
  diffuse,  ///< the third segments of diffuse paths: they have nothing in common; closest hit
  bounce,   ///< of the scene's own paths after some bounces (0: its camera rays); closest hit
};

/// Bytes that a file of such rays has at most: fewer where paths end before.
std::uint64_t ray_bytes_max(RayKind kind, int size);

/// Rays in a prepared scene, by pixels in Morton order of an image of `size` x `size`, a power of
/// two. Paths that end before are left out, and more paths are followed through each pixel instead:
/// for diffuse rays until there are size^2, or the whole image adds none; for RayKind::bounce,
/// which alone has `bounces`, 64 of them. Throws Error where there is no such ray.
RaySet generate_rays(RayKind kind, const SceneData& scene, int size, int bounces = 0);

}  // namespace pt
