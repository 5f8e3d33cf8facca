// Makes sets of rays to measure traversal with.
#pragma once

#include "common/accel/triangle_tree_data.h"
#include "common/scene/camera.h"
#include "common/trace/ray_file.h"

namespace pt {

enum class RayKind {
  primary,  ///< through the pixels' centres, in Morton order; closest hit
  ao,       ///< eight cosine-distributed rays where each primary one hits; any hit
  diffuse,  ///< the third segments of diffuse paths: they have nothing in common; closest hit
};

inline constexpr int ao_rays = 8;

/// Lengths in units of the scene.
struct RayKindSizes {
  float offset = 0;       ///< of origins off the surface that they leave, along its normal
  float ao_distance = 0;  ///< t_max of ambient occlusion
};

/// 0.005 and 50 for a mesh whose bounding box has a diagonal of 1000.
RayKindSizes scale_ray_kinds(const Bounds& bounds);

/// For an image of `size` x `size` pixels, a power of two; the camera is one of such an image.
/// Paths that escape are left out; for diffuse rays, more paths are followed until there are size^2
/// rays, or nothing has been found by the whole image.
RaySet generate_rays(RayKind kind, const TriangleTreeData& tree, const Camera& camera, int size,
                     const RayKindSizes& sizes);

}  // namespace pt
