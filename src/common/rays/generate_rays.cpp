#include "common/rays/generate_rays.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <limits>

#include "common/accel/ray_record.h"
#include "common/error/error.h"
#include "common/render/dispatch.h"
#include "common/sampling/random.h"
#include "common/sampling/warp.h"
#include "common/scene/data/camera.h"
#include "common/scene/data/scene_data.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/transport/follow_path.h"
#include "common/transport/generate_camera_path.h"

namespace pt {
namespace {

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

/// A cosine-distributed ray from where `ray` hit a surface, on the side from which it came, its
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

  /// The third segment of a path that every surface scatters as a diffuse one; no_ray if it escapes
  /// before.
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

  /// A ray of a path that the scene's materials scatter; no_ray if it ends before.
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
      const Scattering next = scatter_at_surface<Traits>(scene_, ray, hit, path, settings,
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
    return surface_at<ShadingTraits<Traits>>(scene_, ray.ray(), hit).point.normal;
  }

  const Scene& scene_;
  const RayKindSizes& sizes_;
};

/// How often each pixel may be gone through.
std::uint32_t samples_max(RayKind kind) {
  if (kind == RayKind::bounce) return 64;
  return kind == RayKind::diffuse ? std::numeric_limits<std::uint32_t>::max() : 1;
}

std::uint32_t rays_per_pixel(RayKind kind) { return kind == RayKind::ao ? ao_rays : 1; }

template <class Traits>
void follow(const RayPaths<Traits>& paths, RayKind kind, int bounces, std::uint32_t pixel,
            std::uint32_t sample, RayRecord* rays) {
  switch (kind) {
    case RayKind::primary:
      *rays = paths.primary(pixel);
      return;
    case RayKind::ao:
      paths.occlusion(pixel, rays);
      return;
    case RayKind::diffuse:
      *rays = paths.third_segment(pixel, sample);
      return;
    case RayKind::bounce:
      *rays = paths.after_bounces(pixel, sample, bounces);
      return;
  }
}

template <class Traits>
std::vector<RayRecord> collect(const RayPaths<Traits>& paths, RayKind kind, int bounces,
                               std::uint32_t pixels) {
  const std::size_t per_pixel = rays_per_pixel(kind);
  std::vector<RayRecord> rays, made(per_pixel * pixels);
  for (std::uint32_t sample = 0; sample < samples_max(kind); ++sample) {
    tbb::parallel_for(std::uint32_t{0}, pixels, [&](std::uint32_t i) {
      follow(paths, kind, bounces, i, sample, &made[per_pixel * i]);
    });
    const std::size_t before = rays.size();
    for (const RayRecord& ray : made) {
      if (ray.t_max > 0.0f && rays.size() < made.size()) rays.push_back(ray);
    }
    if (rays.size() == made.size()) break;
    if (kind == RayKind::diffuse && rays.size() == before) break;
  }
  return rays;
}

}  // namespace

std::uint64_t ray_bytes_max(RayKind kind, int size) {
  const auto side = static_cast<std::uint64_t>(size);
  return side * side * rays_per_pixel(kind) * sizeof(RayRecord);
}

RaySet generate_rays(RayKind kind, const SceneData& scene, int size, int bounces) {
  const Scene view = host_view(scene, size, size);
  const RayKindSizes sizes = scale_ray_kinds(scene_bounds(scene));
  const auto pixels = static_cast<std::uint32_t>(size) * static_cast<std::uint32_t>(size);
  RaySet set;
  set.type = kind == RayKind::ao ? RayType::any : RayType::closest;
  dispatch_traits(CpuSceneKinds{}, scene.traits, [&](auto traits) {
    set.rays = collect(RayPaths<decltype(traits)>(view, sizes), kind, bounces, pixels);
  });
  if (set.rays.empty()) {
    throw Error(
        fmt::format("rays: no path of scene '{}' gets far enough; expected a camera that "
                    "sees surfaces, or fewer bounces",
                    scene.name));
  }
  return set;
}

}  // namespace pt
