// Step 3b: the ray met a surface, which may emit, reflect light from a light source, and send the
// path on (pbrt-v4, section 13.2.2: path tracing with multiple importance sampling).
#pragma once

#include "common/sampling/mis.h"
#include "common/transport/intersect.h"
#include "common/transport/path.h"
#include "common/transport/path_limits.h"
#include "common/transport/sample_light.h"

namespace pt {

/// What a surface does with a path. `ray` is meaningful only where `alive`.
struct Scattering {
  bool alive = false;
  Ray ray;
  Color emitted = Color(0.0f);  ///< to be added to the path's sample
  ShadowRay shadow;             ///< to be traced unless its radiance is black
};

/// beta * Le, weighted against light sampling, which could have found the same point.
template <class Traits>
PT_HD Color emitted_radiance(const Scene& scene, const Ray& ray, const Hit& hit,
                             const PathState& path, const Surface& surface) {
  const Color& emission = surface.material.emission;
  if (is_black(emission) || dot(ray.direction, surface.point.normal) >= 0.0f) {
    return Color(0.0f);
  }
  return path.beta * emission * power_heuristic(path.bsdf_pdf, light_pdf<Traits>(scene, ray, hit));
}

/// The ray from a surface to where `light`, sampled as seen from `from`, wants it to end. Where a
/// shading normal lets the light come through the surface, the ray begins on its other side.
template <class Traits>
PT_HD ShadowRay spawn_shadow_ray(const SurfacePoint& point, const Vec3& from,
                                 const IncidentLight& light, const Color& radiance) {
  constexpr bool shading_normals = Traits::geometry != Geometry::spheres_and_quads;
  const Vec3 origin = shading_normals ? spawn_origin(point, light.wi) : from;
  const Vec3 way = shading_normals ? light.end + (from - origin) : light.end;
  const float distance2 = dot(way, way);
  if (!(distance2 > 0.0f)) return {};
  const float inverse = inverse_sqrt(distance2);
  return {{origin, multiply_rounded(way, Vec3(inverse))},
          multiply_rounded(distance2, inverse),
          radiance};
}

/// One light, asked for its direct contribution (next-event estimation), as seen from where rays
/// begin that the BSDF sends: see light_sample.h.
template <class Traits, class Bsdf>
PT_HD ShadowRay sample_direct_light(const Scene& scene, const PathState& path, const Bsdf& bsdf,
                                    const Surface& surface, const Vec3& wo, const Vec4& u) {
  const Vec3 from = spawn_origin(surface.point, wo);
  IncidentLight light;
  if constexpr (Traits::lighting == Lighting::emitters) {
    light = sample_emitter(scene, from, u);
  } else {
    light = sample_light(scene, from, u);
  }
  if (light.pdf <= 0.0f) return {};
  const Vec3& n = surface.shading_normal;
  const Color f = bsdf.evaluate(wo, light.wi, n);
  if (is_black(f)) return {};
  const float weight =
      light.is_delta ? 1.0f : power_heuristic(light.pdf, bsdf.pdf(wo, light.wi, n));
  return spawn_shadow_ray<Traits>(surface.point, from, light,
                                  path.beta * f * light.radiance * (weight / light.pdf));
}

/// `path.rays` counts the ray that hit. `scatter` and `light` are the blocks of random numbers of
/// that name (random.h); `light` is not read in a scene without lights. Updates the path's
/// throughput, density and counts. A path ends when it is absorbed, has traced all of its rays or
/// loses at Russian roulette, which `scatter.w` decides.
template <class Traits>
PT_HD Scattering shade_surface(const Scene& scene, const Ray& ray, const Hit& hit, PathState& path,
                               const PathLimits& limits, const Vec4& scatter, const Vec4& light) {
  constexpr bool has_lights = Traits::has_lights;
  const Surface surface = surface_at<Traits>(scene, ray, hit);
  const Vec3& n = surface.shading_normal;
  const Vec3 wo = -ray.direction;
  Scattering result;
  if constexpr (has_lights) {
    result.emitted = emitted_radiance<Traits>(scene, ray, hit, path, surface);
  }
  if (path.rays >= limits.max_depth) return result;
  if (Traits::lighting == Lighting::full && surface.material.one_sided && dot(wo, n) <= 0.0f) {
    return result;
  }

  BsdfSample next;
  visit(surface.material, [&](const auto& bsdf) {
    if constexpr (has_lights) {
      path.bsdf_pdf = PathState::delta_distribution;
      if (!bsdf.is_delta() && limits.ask_lights) {
        result.shadow = sample_direct_light<Traits>(scene, path, bsdf, surface, wo, light);
      }
    }
    next = bsdf.sample(wo, n, scatter);
    if constexpr (has_lights) {
      if (!bsdf.is_delta() && limits.ask_lights) path.bsdf_pdf = bsdf.pdf(wo, next.wi, n);
    }
  });
  if constexpr (has_lights) {
    if (!is_black(result.shadow.radiance)) ++path.shadow_rays;
  }
  path.beta = multiply_rounded(path.beta, next.weight);
  if (limits.is_roulette(path.rays)) play_roulette(path.beta, scatter.w, next.outside);
  result.alive = !is_black(path.beta);
  result.ray = spawn_ray(surface.point, next.wi);
  return result;
}

}  // namespace pt
