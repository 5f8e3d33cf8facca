#include "common/trace/path_rays.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "common/error.h"
#include "common/render/dispatch.h"
#include "common/scene/prepare_scene.h"
#include "common/trace/ray_sets.h"
#include "common/transport/generate_camera_path.h"
#include "common/transport/shade_surface.h"

namespace pt {
namespace {

constexpr std::uint32_t samples_max = 64;
constexpr std::uint64_t seed = 1;

/// False: the path has ended before.
template <class Traits>
bool follow_path(const Scene& scene, std::uint32_t pixel, std::uint32_t sample, int bounces,
                 Ray& ray) {
  auto random = PhiloxSource{seed}.open({pixel, sample, 0});
  const PathLimits limits{1u << 15, 0, false};
  PathState path;
  ray = generate_camera_path(scene, pixel, random.draw(scatter_block(0)));
  for (int bounce = 0; bounce < bounces; ++bounce) {
    const Hit hit = intersect_closest<Traits>(scene, ray);
    ++path.rays;
    if (hit.is_miss()) return false;
    const Scattering next = shade_surface<Traits>(
        scene, ray, hit, path, limits, random.draw(scatter_block(path.rays)), Vec4(0.0f));
    if (!next.alive) return false;
    ray = next.ray;
  }
  return true;
}

}  // namespace

RaySet generate_path_rays(const SceneData& scene, int bounce, int size) {
  const Scene view = host_view(scene, size, size);
  const auto pixels = static_cast<std::uint32_t>(size) * static_cast<std::uint32_t>(size);
  std::vector<Ray> rays(pixels);
  std::vector<char> is_alive(pixels);
  RaySet set;
  for (std::uint32_t sample = 0; sample < samples_max && set.rays.size() < pixels; ++sample) {
    dispatch_traits(CpuSceneKinds{}, scene.traits, [&](auto traits) {
      tbb::parallel_for(std::uint32_t{0}, pixels, [&](std::uint32_t i) {
        const std::uint32_t pixel = pack_pixel(morton_coordinate(i), morton_coordinate(i >> 1));
        is_alive[i] = follow_path<decltype(traits)>(view, pixel, sample, bounce, rays[i]);
      });
    });
    for (std::uint32_t i = 0; i < pixels && set.rays.size() < pixels; ++i) {
      if (is_alive[i]) set.rays.push_back({rays[i].origin, 0.0f, rays[i].direction, 1e30f});
    }
  }
  if (set.rays.empty()) {
    throw Error(
        fmt::format("rays: no path of scene '{}' lives for {} bounces", scene.name, bounce));
  }
  return set;
}

}  // namespace pt
