#include "common/trace/generate_rays.h"

#include <tbb/parallel_for.h>

#include "common/accel/traverse_cwbvh.h"
#include "common/trace/ray_sets.h"

namespace pt {
namespace {

constexpr float no_end = 1e30f;
constexpr RayRecord no_ray = {{0, 0, 0}, 0.0f, {0, 0, 0}, -1.0f};

/// Follows paths through a mesh.
class PathMaker {
 public:
  PathMaker(const TriangleTree& tree, const Camera& camera, const RayKindSizes& sizes)
      : tree_(tree), camera_(camera), sizes_(sizes) {}

  Hit trace(const RayRecord& ray) const {
    return closest_triangle_cwbvh<false>(tree_, ray.ray(), ray.t_min, ray.t_max);
  }

  RayRecord bounce(const RayRecord& ray, const Hit& hit, float t_max, std::uint32_t pixel,
                   std::uint32_t dimension) const {
    const Triangle& t = tree_.triangles[hit.primitive];
    return make_bounce_ray(ray, hit.t, t.v0, t.v1, t.v2, sizes_.offset, t_max, pixel, dimension);
  }

  void occlusion(std::uint32_t pixel, RayRecord* rays) const {
    const RayRecord ray = make_primary_ray(camera_, pixel);
    const Hit hit = trace(ray);
    for (std::uint32_t i = 0; i < ao_rays; ++i)
      rays[i] = hit.is_miss() ? no_ray : bounce(ray, hit, sizes_.ao_distance, pixel, i);
  }

  /// The third segment of a path, or no_ray; `sample` tells the paths of a pixel apart.
  RayRecord third_segment(std::uint32_t pixel, std::uint32_t sample) const {
    RayRecord ray = make_primary_ray(camera_, pixel);
    for (std::uint32_t i = 0; i < 2; ++i) {
      const Hit hit = trace(ray);
      if (hit.is_miss()) return no_ray;
      ray = bounce(ray, hit, no_end, pixel, ao_rays + 2 * sample + i);
    }
    return ray;
  }

 private:
  const TriangleTree& tree_;
  const Camera& camera_;
  const RayKindSizes& sizes_;
};

void append_rays(std::vector<RayRecord>& rays, const std::vector<RayRecord>& more) {
  for (const RayRecord& ray : more)
    if (ray.t_max > 0.0f) rays.push_back(ray);
}

}  // namespace

RayKindSizes scale_ray_kinds(const Bounds& bounds) {
  const float diagonal = glm::length(bounds.max - bounds.min);
  return {5e-6f * diagonal, 0.05f * diagonal};
}

RaySet generate_rays(RayKind kind, const TriangleTreeData& tree, const Camera& camera, int size,
                     const RayKindSizes& sizes) {
  const TriangleTree view = tree.view();
  const PathMaker paths(view, camera, sizes);
  const auto pixels = static_cast<std::uint32_t>(size) * static_cast<std::uint32_t>(size);
  RaySet set;
  set.type = kind == RayKind::ao ? RayType::any : RayType::closest;
  if (kind == RayKind::primary) {
    set.rays.resize(pixels);
    tbb::parallel_for(0u, pixels,
                      [&](std::uint32_t i) { set.rays[i] = make_primary_ray(camera, i); });
    return set;
  }
  std::vector<RayRecord> made(kind == RayKind::ao ? std::size_t{ao_rays} * pixels : pixels);
  if (kind == RayKind::ao) {
    tbb::parallel_for(
        0u, pixels, [&](std::uint32_t i) { paths.occlusion(i, &made[std::size_t{ao_rays} * i]); });
    append_rays(set.rays, made);
    return set;
  }
  for (std::uint32_t sample = 0; set.rays.size() < pixels; ++sample) {
    const std::size_t before = set.rays.size();
    tbb::parallel_for(0u, pixels,
                      [&](std::uint32_t i) { made[i] = paths.third_segment(i, sample); });
    append_rays(set.rays, made);
    if (set.rays.size() == before) break;
  }
  if (set.rays.size() > pixels) set.rays.resize(pixels);
  return set;
}

}  // namespace pt
