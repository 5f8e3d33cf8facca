#include "common/rays/generate_rays.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <limits>

#include "common/error/error.h"
#include "common/rays/ray_paths.h"
#include "common/render/dispatch.h"
#include "common/scene/data/frame_scene.h"
#include "common/scene/prepare/prepare_scene.h"

namespace pt {
namespace {

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
