// The paths of which sets of rays are made.
#pragma once

#include "common/rays/generate_rays.h"
#include "common/rays/ray_sets.h"
#include "common/transport/follow_path.h"
#include "common/transport/generate_camera_path.h"

namespace pt {

inline constexpr std::uint32_t ao_rays = 8;  ///< of a primary hit

/// Lengths in units of the scene.
struct RayKindSizes {
  float offset = 0;       ///< of origins off the surface that they leave, along its normal
  float ao_distance = 0;  ///< t_max of ambient occlusion
};

/// 0.005 and 50 for a bounding box with a diagonal of 1000.
inline RayKindSizes scale_ray_kinds(const Bounds& bounds) {
  const float diagonal = glm::length(bounds.max - bounds.min);
  return {5e-6f * diagonal, 0.05f * diagonal};
}

/// Follows paths through a scene with these Traits. A pixel's index is its position in Morton
/// order; `sample` tells the paths of a pixel apart.
template <class Traits>
class RayPaths {
 public:
  static constexpr RayRecord no_ray = {{0, 0, 0}, 0.0f, {0, 0, 0}, -1.0f};

  RayPaths(const Scene& scene, const RayKindSizes& sizes) : scene_(scene), sizes_(sizes) {}

  RayRecord primary(std::uint32_t pixel) const { return make_primary_ray(scene_.camera, pixel); }

  /// ao_rays of them; no_ray where the primary one misses.
  void occlusion(std::uint32_t pixel, RayRecord* rays) const {
    const RayRecord ray = primary(pixel);
    const Hit hit = trace(ray);
    const Vec3 normal = hit.is_miss() ? Vec3(0.0f) : normal_at(ray, hit);
    for (std::uint32_t i = 0; i < ao_rays; ++i) {
      rays[i] = hit.is_miss() ? no_ray
                              : make_bounce_ray(ray, hit.t, normal, sizes_.offset,
                                                sizes_.ao_distance, pixel, i);
    }
  }

  /// Of a path that every surface scatters as a diffuse one; no_ray if it escapes before.
  RayRecord third_segment(std::uint32_t pixel, std::uint32_t sample) const {
    RayRecord ray = primary(pixel);
    for (std::uint32_t i = 0; i < 2; ++i) {
      const Hit hit = trace(ray);
      if (hit.is_miss()) return no_ray;
      ray = make_bounce_ray(ray, hit.t, normal_at(ray, hit), sizes_.offset, no_end, pixel,
                            ao_rays + 2 * sample + i);
    }
    return ray;
  }

  /// Of a path that the scene's materials scatter; no_ray if it ends before.
  RayRecord after_bounces(std::uint32_t pixel, std::uint32_t sample, int bounces) const {
    const std::uint32_t pixel_id =
        pack_pixel(morton_coordinate(pixel), morton_coordinate(pixel >> 1));
    auto random = PhiloxSource{bounce_seed}.open({pixel_id, sample, 0});
    const PathSettings settings{1u << 15, 0, false};
    PathState path;
    Ray ray = generate_camera_path(scene_, pixel_id, random.draw(scatter_block(0)));
    for (int bounce = 0; bounce < bounces; ++bounce) {
      const Hit hit = intersect_closest<Traits>(scene_, ray);
      ++path.rays;
      if (hit.is_miss()) return no_ray;
      const Scattering next = surface_scattering<Traits>(scene_, ray, hit, path, settings,
                                                         eager_shading<Traits>(random, path));
      if (!next.alive) return no_ray;
      ray = next.ray;
    }
    return {ray.origin, 0.0f, ray.direction, no_end};
  }

 private:
  static constexpr float no_end = 1e30f;
  static constexpr std::uint64_t bounce_seed = 1;

  Hit trace(const RayRecord& ray) const { return intersect_closest<Traits>(scene_, ray.ray()); }

  Vec3 normal_at(const RayRecord& ray, const Hit& hit) const {
    return surface_at<Traits>(scene_, ray.ray(), hit).point.normal;
  }

  const Scene& scene_;
  const RayKindSizes& sizes_;
};

}  // namespace pt
