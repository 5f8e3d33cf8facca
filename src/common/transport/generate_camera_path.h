// Step 1: a path begins at the camera.
#pragma once

#include "common/sampling/sampler_source.h"
#include "common/scene/data/scene.h"
#include "common/transport/path.h"
#include "common/transport/shutter_time.h"

namespace pt {

/// The camera ray of a new path through a point of its pixel (x | y << 16), or near it, chosen by
/// the reconstruction filter: uniformly, for a box. `u`: block 0 of the path's random numbers;
/// x, y for the point, z, w for the lens.
template <bool specialized = false>
PT_HD Ray generate_camera_path(const Scene& scene, const Camera& camera, std::uint32_t pixel,
                               const Vec4& u) {
  lanes_of(scene).count(LanePoint::generate);
  const PixelFilter& filter = scene.filter;
  const Vec2 offset =
      specialized ? filter.offsets(u.x, u.y) : Vec2(filter.offset(u.x), filter.offset(u.y));
  Ray ray = camera_ray<specialized>(camera, static_cast<float>(pixel_x(pixel)) + offset.x,
                                    static_cast<float>(pixel_y(pixel)) + offset.y, u.z, u.w);
  set_lanes(ray, lanes_of(scene));
  return ray;
}

template <bool specialized = false>
PT_HD Ray generate_camera_path(const Scene& scene, std::uint32_t pixel, const Vec4& u) {
  return generate_camera_path<specialized>(scene, scene.camera, pixel, u);
}

/// The same for the stream of a path's numbers, of which `u` is block 0. `time`: of the path, with
/// `has_motion`.
template <bool has_motion = false, class Stream>
PT_HD Ray generate_camera_path(const Scene& scene, const Stream& random, std::uint32_t pixel,
                               const Vec4& u, float time = 0.0f) {
  const PixelPoint point = pixel_point(random, pixel, u);
  if constexpr (has_motion)
    return generate_camera_path(scene, camera_at(scene, time), point.pixel, point.u);
  return generate_camera_path<Stream::is_specialized>(scene, point.pixel, point.u);
}

}  // namespace pt
