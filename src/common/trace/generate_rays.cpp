#include "common/trace/generate_rays.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <charconv>
#include <functional>

#include "common/error.h"
#include "common/math/frame.h"
#include "common/render/dispatch.h"
#include "common/scene/frame_scene.h"
#include "common/scene/prepare_scene.h"
#include "common/trace/ray_sets.h"
#include "common/transport/generate_camera_path.h"
#include "common/transport/shade_surface.h"

namespace pt {
namespace {

constexpr std::uint32_t ao_rays = 8;
constexpr std::uint32_t passes_max = 64;
constexpr std::uint64_t seed = 1;

/// A ray that may have come to nothing: t_max 0.
constexpr RayRecord no_ray = {Vec3(0.0f), 0.0f, Vec3(0.0f), 0.0f};

class Generator {
 public:
  Generator(const SceneData& scene, const RaySetRequest& request)
      : request_(request),
        traits_(scene.traits),
        scene_(host_view(scene, static_cast<int>(request.size), static_cast<int>(request.size))) {
    const Bounds bounds = scene_bounds(scene);
    const float diagonal = glm::length(bounds.max - bounds.min);
    offset_ = 5e-6f * diagonal;
    ao_distance_ = request.ao_distance > 0.0f ? request.ao_distance : 0.05f * diagonal;
  }

  RaySet generate() {
    RaySet set;
    if (request_.kind == RayKind::ao) set.type = RayType::any;
    dispatch_traits(CpuSceneKinds{}, traits_, [&](auto traits) {
      using T = decltype(traits);
      switch (request_.kind) {
        case RayKind::primary:
          return fill(set, 1, 1, [&](std::uint32_t i, std::uint32_t, RayRecord* rays) {
            rays[0] = make_primary_ray(scene_.camera, i);
          });
        case RayKind::ao:
          return fill(set, ao_rays, 1, [&](std::uint32_t i, std::uint32_t, RayRecord* rays) {
            occlusion_rays<T>(i, rays);
          });
        case RayKind::diffuse:
          return fill(set, 1, passes_max,
                      [&](std::uint32_t i, std::uint32_t pass, RayRecord* rays) {
                        rays[0] = diffuse_ray<T>(i, pass);
                      });
        case RayKind::bounce:
          return fill(set, 1, passes_max,
                      [&](std::uint32_t i, std::uint32_t pass, RayRecord* rays) {
                        rays[0] = bounce_ray<T>(i, pass);
                      });
      }
    });
    if (set.rays.empty())
      throw Error("rays: no path lives so long; expected another scene or kind");
    return set;
  }

 private:
  std::uint32_t pixels() const { return request_.size * request_.size; }

  /// Calls make(pixel, pass, rays) for `count` rays of each pixel, in passes until the set is full,
  /// and keeps those that there are.
  template <class Make>
  void fill(RaySet& set, std::uint32_t count, std::uint32_t passes, Make&& make) const {
    std::vector<RayRecord> rays(std::size_t{pixels()} * count);
    const std::size_t wanted = rays.size();
    for (std::uint32_t pass = 0; pass < passes && set.rays.size() < wanted; ++pass) {
      tbb::parallel_for(std::uint32_t{0}, pixels(), [&](std::uint32_t i) {
        make(i, pass, rays.data() + std::size_t{i} * count);
      });
      for (const RayRecord& ray : rays) {
        if (ray.t_max > 0.0f && set.rays.size() < wanted) set.rays.push_back(ray);
      }
    }
  }

  /// Cosine-distributed about the surface's normal, on the side from which `ray` came.
  template <class T>
  RayRecord cosine_ray(const Ray& ray, const Hit& hit, float t_max, std::uint32_t index,
                       std::uint32_t dimension) const {
    const SurfacePoint point = surface_at<T>(scene_, ray, hit).point;
    const Vec3 normal = glm::dot(point.normal, ray.direction) > 0.0f ? -point.normal : point.normal;
    const Uint4 bits = philox4x32_10({index, dimension, 0, 0}, 0x7261u, 0x7973u);
    const Vec3 direction =
        sample_cosine_hemisphere(normal, to_unit_float(bits.x), to_unit_float(bits.y));
    return {point.position + offset_ * normal, 0.0f, direction, t_max};
  }

  template <class T>
  void occlusion_rays(std::uint32_t pixel, RayRecord* rays) const {
    const Ray ray = make_primary_ray(scene_.camera, pixel).ray();
    const Hit hit = intersect_closest<T>(scene_, ray);
    for (std::uint32_t k = 0; k < ao_rays; ++k) {
      rays[k] = hit.is_miss() ? no_ray : cosine_ray<T>(ray, hit, ao_distance_, pixel, k);
    }
  }

  template <class T>
  RayRecord diffuse_ray(std::uint32_t pixel, std::uint32_t pass) const {
    RayRecord record = make_primary_ray(scene_.camera, pixel);
    for (std::uint32_t bounce = 0; bounce < 2; ++bounce) {
      const Hit hit = intersect_closest<T>(scene_, record.ray());
      if (hit.is_miss()) return no_ray;
      record = cosine_ray<T>(record.ray(), hit, 1e30f, pixel, 2 * pass + bounce);
    }
    return record;
  }

  template <class T>
  RayRecord bounce_ray(std::uint32_t number, std::uint32_t pass) const {
    const std::uint32_t pixel =
        pack_pixel(morton_coordinate(number), morton_coordinate(number >> 1));
    auto random = PhiloxSource{seed}.open({pixel, pass, 0});
    const PathLimits limits{1u << 15, 0, false};
    PathState path;
    Ray ray = generate_camera_path(scene_, pixel, random.draw(scatter_block(0)));
    for (int bounce = 0; bounce < request_.bounce; ++bounce) {
      const Hit hit = intersect_closest<T>(scene_, ray);
      ++path.rays;
      if (hit.is_miss()) return no_ray;
      const Scattering next = shade_surface<T>(scene_, ray, hit, path, limits,
                                               random.draw(scatter_block(path.rays)), Vec4(0.0f));
      if (!next.alive) return no_ray;
      ray = next.ray;
    }
    return {ray.origin, 0.0f, ray.direction, 1e30f};
  }

  const RaySetRequest request_;
  const SceneTraits traits_;
  const Scene scene_;
  float offset_, ao_distance_;
};

}  // namespace

RaySetRequest parse_ray_kind(const std::string& text) {
  RaySetRequest request;
  if (text == "primary") return request;
  if (text == "ao") request.kind = RayKind::ao;
  if (text == "diffuse") request.kind = RayKind::diffuse;
  if (request.kind != RayKind::primary) return request;
  const std::string prefix = "bounce:";
  if (text.starts_with(prefix)) {
    request.kind = RayKind::bounce;
    const char* begin = text.data() + prefix.size();
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(begin, end, request.bounce);
    if (error == std::errc() && stop == end && request.bounce >= 0 && request.bounce <= 1000) {
      return request;
    }
  }
  throw Error(
      fmt::format("--kind {}: expected primary, ao, diffuse or bounce:K, K from 0 to 1000", text));
}

RaySet generate_rays(const SceneData& scene, const RaySetRequest& request) {
  if (builds_on_device(scene)) {
    throw Error("rays: the scene's tree must be built on the host; expected --builder sah or sbvh");
  }
  return Generator(scene, request).generate();
}

}  // namespace pt
