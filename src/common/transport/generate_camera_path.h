// Step 1: a path begins at the camera.
#pragma once

#include "common/sampling/sampler_source.h"
#include "common/scene/scene.h"
#include "common/transport/path.h"

namespace pt {

/// The camera ray of a new path through a point of its pixel (x | y << 16), or near it, chosen by
/// the reconstruction filter: uniformly, for a box. `u`: block 0 of the path's random numbers;
/// x, y for the point, z, w for the lens.
template <bool specialized = false>
PT_HD Ray generate_camera_path(const Scene& scene, std::uint32_t pixel, const Vec4& u) {
  lanes_of(scene).count(LanePoint::generate);
  const PixelFilter& filter = scene.filter;
  const Vec2 offset =
      specialized ? filter.offsets(u.x, u.y) : Vec2(filter.offset(u.x), filter.offset(u.y));
  Ray ray = camera_ray(scene.camera, static_cast<float>(pixel_x(pixel)) + offset.x,
                       static_cast<float>(pixel_y(pixel)) + offset.y, u.z, u.w);
  set_lanes(ray, lanes_of(scene));
  return ray;
}

/// The same for the stream of a path's numbers, of which `u` is block 0.
template <class Stream>
PT_HD Ray generate_camera_path(const Scene& scene, const Stream& random, std::uint32_t pixel,
                               const Vec4& u) {
  const PixelPoint point = pixel_point(random, pixel, u);
  return generate_camera_path<Stream::is_specialized>(scene, point.pixel, point.u);
}

}  // namespace pt
