// Sets of rays from any scene, for measuring traversal.
#pragma once

#include <string>

#include "common/scene/scene_data.h"
#include "common/trace/ray_file.h"

namespace pt {

enum class RayKind {
  primary,  ///< through the pixels' centres, pixels in Morton order
  ao,       ///< eight cosine-distributed ones from each primary hit, any hit
  diffuse,  ///< the third segment of paths that bounce with a cosine: fully incoherent
  bounce    ///< the rays of the scene's own paths after some bounces, in the order of their pixels
};

struct RaySetRequest {
  RayKind kind = RayKind::primary;
  int bounce = 0;             ///< of RayKind::bounce; 0: the camera rays of a path tracer
  std::uint32_t size = 2048;  ///< of the image, a power of two: size * size pixels
  float ao_distance = 0.0f;   ///< t_max of ao; 0: a twentieth of the scene's diagonal
};

/// "primary", "ao", "diffuse" or "bounce:K". Throws Error.
RaySetRequest parse_ray_kind(const std::string& text);

/// `scene` is prepared, its tree built on the host. Origins of ao and diffuse rays lie 5e-6 of the
/// scene's diagonal off the surface. Rays that ended or escaped before their turn are dropped;
/// diffuse and bounce sets are filled up with further samples until there is one per pixel, unless
/// nearly all paths escape. Throws Error where no ray is left.
RaySet generate_rays(const SceneData& scene, const RaySetRequest& request);

}  // namespace pt
