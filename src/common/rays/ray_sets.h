// The rays of sets to measure traversal with: through a pixel's centre, off a diffuse surface.
#pragma once

#include "common/accel/ray_record.h"
#include "common/sampling/philox.h"
#include "common/sampling/warp.h"
#include "common/scene/data/camera.h"

namespace pt {

/// The even bits of x, packed: a coordinate of a Morton number.
PT_HD std::uint32_t morton_coordinate(std::uint32_t x) {
  x &= 0x55555555u;
  x = (x | x >> 1) & 0x33333333u;
  x = (x | x >> 2) & 0x0f0f0f0fu;
  x = (x | x >> 4) & 0x00ff00ffu;
  return (x | x >> 8) & 0x0000ffffu;
}

/// The ray through the centre of a pixel, pixels in Morton order: 32 in a row are 8 x 4 pixels.
PT_HD RayRecord make_primary_ray(const Camera& camera, std::uint32_t pixel) {
  const float x = static_cast<float>(morton_coordinate(pixel)) + 0.5f;
  const float y = static_cast<float>(morton_coordinate(pixel >> 1)) + 0.5f;
  const Ray ray = camera_ray(camera, x, y, 0.0f, 0.0f);
  return {ray.origin, 0.0f, ray.direction, 1e30f};
}

/// A cosine-distributed ray from where `ray` met a surface, on the side from which it came, its
/// origin `offset` off the surface. The draw is numbered by (index, dimension).
PT_HD RayRecord make_bounce_ray(const RayRecord& ray, float t, const Vec3& surface_normal,
                                float offset, float t_max, std::uint32_t index,
                                std::uint32_t dimension) {
  const Vec3 normal =
      glm::dot(surface_normal, ray.direction) > 0.0f ? -surface_normal : surface_normal;
  const Uint4 bits = philox4x32_10({index, dimension, 0, 0}, 0x7261u, 0x7973u);
  const Vec3 direction =
      sample_cosine_hemisphere(normal, to_unit_float(bits.x), to_unit_float(bits.y));
  return {ray.origin + t * ray.direction + offset * normal, 0.0f, direction, t_max};
}

}  // namespace pt
