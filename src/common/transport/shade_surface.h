// Step 3b: the ray met a surface, which may emit, reflect light from a light source, and send the
// path on (pbrt-v4, section 13.2.2: path tracing with multiple importance sampling).
#pragma once

#include "common/light/area_light.h"
#include "common/sampling/mis.h"
#include "common/transport/intersect.h"
#include "common/transport/path.h"

namespace pt {

/// What a surface does with a path. `ray` is meaningful only where `alive`.
struct Scattering {
  bool alive = false;
  Ray ray;
  Color emitted = Color(0.0f);  ///< to be added to the path's sample
  ShadowRay shadow;             ///< to be traced unless its radiance is black
};

/// beta * Le, weighted against light sampling, which could have found the same point.
PT_HD Color emitted_radiance(const Scene& scene, const Ray& ray, const Hit& hit,
                             const PathState& path, const SurfacePoint& point,
                             const Material& material) {
  if (is_black(material.emission) || glm::dot(ray.direction, point.normal) >= 0.0f) {
    return Color(0.0f);
  }
  const float light_pdf =
      primitive_pdf(scene.primitives, hit.primitive, ray.origin, ray.direction, hit.t) /
      static_cast<float>(scene.light_count);
  return path.beta * material.emission * power_heuristic(path.bsdf_pdf, light_pdf);
}

/// One light, chosen uniformly, asked for its direct contribution (next-event estimation).
template <class Bsdf>
PT_HD ShadowRay sample_direct_light(const Scene& scene, const PathState& path, const Bsdf& bsdf,
                                    const SurfacePoint& point, const Vec3& wo, const Vec4& u) {
  const float count = static_cast<float>(scene.light_count);
  const std::uint32_t choice = static_cast<std::uint32_t>(u.z * count);
  const std::uint32_t primitive =
      scene.lights[choice < scene.light_count ? choice : scene.light_count - 1];
  const LightSample light = sample_primitive(scene.primitives, primitive, point.position, u.x, u.y);
  const float light_pdf = light.pdf / count;
  if (light_pdf <= 0.0f) return {};
  const Color f = bsdf.evaluate(wo, light.wi, point.normal);
  if (is_black(f)) return {};
  const float weight = power_heuristic(light_pdf, bsdf.pdf(wo, light.wi, point.normal));
  return {spawn_ray(point, light.wi), light.distance,
          path.beta * f * scene.material(primitive).emission * (weight / light_pdf)};
}

/// `path.rays` counts the ray that hit. `scatter` and `light` are the blocks of random numbers of
/// that name (random.h); `light` is not read in a scene without lights. Updates the path's
/// throughput, density and counts. A path ends when it is absorbed or has traced `max_depth` rays.
template <bool has_lights>
PT_HD Scattering shade_surface(const Scene& scene, const Ray& ray, const Hit& hit, PathState& path,
                               std::uint32_t max_depth, const Vec4& scatter, const Vec4& light) {
  const SurfacePoint point = surface_point(scene.primitives, ray, hit);
  const Material material = scene.material(hit.primitive);
  const Vec3 wo = -ray.direction;
  Scattering result;
  if constexpr (has_lights) {
    result.emitted = emitted_radiance(scene, ray, hit, path, point, material);
  }
  if (path.rays >= max_depth) return result;

  BsdfSample next;
  visit(material, [&](const auto& bsdf) {
    if constexpr (has_lights) {
      if (!bsdf.is_delta()) {
        result.shadow = sample_direct_light(scene, path, bsdf, point, wo, light);
      }
    }
    next = bsdf.sample(wo, point.normal, scatter);
    if constexpr (has_lights) {
      path.bsdf_pdf =
          bsdf.is_delta() ? PathState::delta_distribution : bsdf.pdf(wo, next.wi, point.normal);
    }
  });
  if constexpr (has_lights) {
    if (!is_black(result.shadow.radiance)) ++path.shadow_rays;
  }
  path.beta = multiply_rounded(path.beta, next.weight);
  result.alive = !is_black(path.beta);
  result.ray = spawn_ray(point, next.wi);
  return result;
}

}  // namespace pt
