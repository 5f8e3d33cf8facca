// Step 3b: the ray hit a surface, which may emit, reflect light from a light source, and send the
// path on (pbrt-v4, section 13.2.2: path tracing with multiple importance sampling).
#pragma once

#include "common/math/transform.h"
#include "common/sampling/mis.h"
#include "common/transport/intersect.h"
#include "common/transport/path.h"
#include "common/transport/resolve_material.h"
#include "common/transport/sample_direction.h"
#include "common/transport/sample_light.h"
#include "common/transport/shading_policy.h"

namespace pt {

/// What a surface does with a path. `ray` is meaningful only where `alive`.
struct Scattering {
  bool alive = false;
  Ray ray;
  Color emitted = Color(0.0f);  ///< to be added to the path's sample
  ShadowRay shadow;  ///< to be traced unless its radiance is black; see EagerShading::aims
};

/// The receiver for light selection.
template <class Traits>
PT_HD Receiver receiver_of(const Surface& surface, const Ray& ray) {
  if constexpr (Traits::lighting != Lighting::full) return {};
  const Vec3& n = surface.shading_normal;
  return make_receiver(dot(ray.direction, n) > 0.0f ? -n : n,
                       !reflects_only(surface.material.kind));
}

/// beta * Le, weighted against light sampling, which could have found the same point.
template <class Traits>
PT_HD Color emitted_radiance(const Scene& scene, const Ray& ray, const Hit& hit,
                             const PathState& path, const Surface& surface, MisHeuristic mis) {
  if (surface.material.emission == no_emission ||
      dot(ray.direction, surface.point.normal) >= 0.0f) {
    return Color(0.0f);
  }
  const Emission emission = scene.emission(surface.material);
  Color Le = emission.radiance;
  if constexpr (Traits::lighting == Lighting::full) {
    Le = textured_noinline(scene, Le, emission.texture, surface.uv);
  }
  float pdf;
  if constexpr (Traits::has_media) {  // seen from where the path was scattered last
    Ray seen = ray;
    Hit from_there = hit;
    seen.origin = add_scaled(ray.origin, -path.medium.travelled, ray.direction);
    from_there.t = hit.t + path.medium.travelled;
    pdf = light_pdf<Traits>(scene, seen, path.receiver, from_there, path.time);
  } else {
    pdf = light_pdf<Traits>(scene, ray, path.receiver, hit, path.time);
  }
  return path.beta * Le * direction_weight(mis, path.bsdf_pdf, pdf);
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
  return {{origin, way * inverse}, distance2 * inverse, radiance};
}

/// The contribution of a sampled light (next-event estimation), given the BSDF's value and density
/// for its direction.
PT_HD Color direct_radiance(const PathState& path, const IncidentLight& light,
                            const BsdfValue& value, MisHeuristic mis) {
  if (light.pdf <= 0.0f || is_black(value.f)) return Color(0.0f);
  const float weight = light.is_delta ? 1.0f : light_weight(mis, light.pdf, value.pdf);
  return path.beta * value.f * light.radiance * divide(weight, light.pdf);
}

/// The same as a shadow ray to the light, which was sampled as seen from `from`.
template <class Traits>
PT_HD ShadowRay ask_light(const PathState& path, const Surface& surface, const Vec3& from,
                          const IncidentLight& light, const BsdfValue& value, MisHeuristic mis) {
  if (light.pdf <= 0.0f || is_black(value.f)) return {};
  return spawn_shadow_ray<Traits>(surface.point, from, light,
                                  direct_radiance(path, light, value, mis));
}

/// Tells `policy` where the light's shadow ray goes; a light without one does not contribute.
template <class Traits, class Policy>
PT_HD void aim_at_light(const Policy& policy, const Surface& surface, const Vec3& from,
                        IncidentLight& light) {
  if (light.pdf <= 0.0f) return;
  const ShadowRay shadow = spawn_shadow_ray<Traits>(surface.point, from, light, Color(1.0f));
  if (is_black(shadow.radiance)) light.pdf = 0.0f;
  policy.aim(shadow);
}

/// Where a ray goes on behind a boundary that lets it through.
struct BoundaryCrossing {
  Ray ray;                  ///< in the same direction
  float length;             ///< from the origin of the ray before
  std::uint16_t medium_id;  ///< where it begins (Media)
};

/// The media on both sides of a surface that a ray in `medium_id` hit.
PT_HD MediumBoundary media_beside(const Scene& scene, const Surface& surface,
                                  std::uint16_t medium_id) {
  return surface.material.is(Material::boundary) ? scene.media.boundaries[surface.material_index]
                                                 : scene.media.same_on_both_sides(medium_id);
}

/// `medium_id`: the medium at the ray's origin.
PT_HD BoundaryCrossing cross_boundary(const Scene& scene, const Ray& ray, const Surface& surface,
                                      std::uint16_t medium_id) {
  const Ray next = spawn_ray(surface.point, ray.direction);
  return {next, dot(next.origin - ray.origin, ray.direction),
          scene.media.behind(media_beside(scene, surface, medium_id), ray.direction,
                             surface.point.normal, medium_id)};
}

/// Whether light goes on through a surface as if it were not there.
PT_HD bool lets_through(const Scene& scene, const Material& material, std::uint32_t index,
                        std::uint16_t medium_id) {
  return material.is(Material::passes) ||
         (material.emission == no_emission && scene.media.hides(index, medium_id));
}

/// Whether a surface that lets light through is thin glass, which reflects a part of it.
PT_HD bool is_pane(const Material& material) {
  return material.is(Material::passes) && material.kind == kind_of<ThinDielectric>;
}

/// The glass of a pane, with its textures in kernels of any kind.
PT_HD ThinDielectric pane_at(const Scene& scene, const Surface& surface) {
  using WithTextures = Traits<Accel::brute, Geometry::triangles, Lighting::full>;
  return make_bsdf<ThinDielectric>(SurfaceParameters<WithTextures>(scene, surface));
}

/// A surface that lets light through.
PT_HD_IN_KERNEL Scattering pass_boundary(const Scene& scene, const Ray& ray, const Surface& surface,
                                         PathState& path) {
  const BoundaryCrossing crossing = cross_boundary(scene, ray, surface, path.medium.id);
  path.medium.id = crossing.medium_id;
  path.medium.travelled += crossing.length;
  ++path.medium.interface_crossings;
  Scattering result;
  result.alive = !is_black(path.beta);
  result.ray = crossing.ray;
  set_lanes(result.ray, lanes_of(scene).at(path.rays));
  return result;
}

/// Around the shading normal, along dp_du where the material needs that.
template <class Traits>
PT_HD Frame shading_frame(const Vec3& normal, const Vec3& dp_du) {
  if constexpr (Traits::lighting == Lighting::full) return make_frame(normal, dp_du);
  return make_frame(normal);
}

/// `path.rays` counts the ray that hit. `policy`: see shading_policy.h; policy.light() is not
/// called in a scene without lights. Updates the path's throughput, density and counts. A path ends
/// when it is absorbed, has traced all of its rays or loses at Russian roulette, which scatter().w
/// decides.
template <class Traits, class Policy>
PT_HD_IN_KERNEL Scattering surface_scattering(const Scene& scene, const Ray& ray, const Hit& hit,
                                              PathState& path, const PathSettings& settings,
                                              const Policy& policy) {
  constexpr bool has_lights = Traits::has_lights, full = Traits::lighting == Lighting::full;
  // The specialised kernels of the paper's scenes stay small: the others do the rest
  // (scene_options.h).
  const MisHeuristic mis = full ? settings.mis : MisHeuristic::power;
  const DirectionSampling directions = full ? settings.directions : DirectionSampling::bsdf;
  lanes_of(ray).count(LanePoint::shade_surface);
  Surface surface = surface_at<Traits>(scene, ray, hit, path.time);
  if constexpr (Traits::has_media) {
    if (lets_through(scene, surface.material, surface.material_index, path.medium.id)) {
      if (!is_pane(surface.material)) return pass_boundary(scene, ray, surface, path);
      const ThinDielectric pane = pane_at(scene, surface);
      // By the number that decides it in ThinDielectric::sample().
      const float cosine = dot(ray.direction, surface.shading_normal);
      if (!(policy.scatter().z < pane.reflectance(cosine))) {
        path.beta *= pane.passed;
        return pass_boundary(scene, ray, surface, path);
      }
    }
  }
  Scattering result;
  if constexpr (has_lights) {
    result.emitted = policy.emit(emitted_radiance<Traits>(scene, ray, hit, path, surface, mis));
  }
  if (path.depth<Traits>() >= settings.max_depth) return result;
  MediumBoundary boundary;
  if constexpr (Traits::has_media) {
    boundary = media_beside(scene, surface, path.medium.id);
  }
  float choice = 0.0f;
  const bool is_nested = full && surface.material.is(Material::nested);
  if (is_nested) choice = policy.scatter().w;
  if constexpr (full) resolve_material(scene, -ray.direction, choice, surface);
  if (full && surface.material.is(Material::one_sided) &&
      dot(ray.direction, surface.shading_normal) >= 0.0f) {
    return result;
  }
  // The light is chosen before the BSDF is known, as seen from where the BSDF's rays begin
  // (light_sample.h): so its code is there once, not once per BSDF.
  const bool asks = has_lights && settings.nee && !surface.material.is(Material::delta);
  const Vec3 from = spawn_origin(surface.point, -ray.direction);
  IncidentLight incident;
  if (asks) {
    lanes_of(ray).count(LanePoint::light);
    if (!full || scene.light_selector.has_tree()) path.receiver = receiver_of<Traits>(surface, ray);
    incident = sample_light<Traits>(scene, from, path.receiver, policy.light(), path.time);
    if constexpr (Policy::aims) aim_at_light<Traits>(policy, surface, from, incident);
  }
  const Vec4 scatter = policy.scatter();
  if (!is_nested) choice = scatter.w;
  const Frame frame = shading_frame<Traits>(surface.shading_normal, surface.dp_du);
  BsdfSample next;
  BsdfValue value;
  const SurfaceParameters<Traits> parameters(scene, surface);
  visit<typename Traits::BsdfList>(surface.material.kind, parameters, [&](const auto& bsdf) {
    const Vec3 wo = frame.to_local(-ray.direction);  // a BSDF may need a part of it
    lanes_of(ray).count(LanePoint::bsdf);
    if (asks) {
      const Vec3 wi = frame.to_local(incident.wi);
      value = bsdf.evaluate(wo, wi);
      value.pdf = direction_pdf(bsdf, directions, wo, wi, value.pdf);
    }
    next = sample_direction(bsdf, directions, wo, Vec3(scatter));
  });
  // The same frame, computed again where registers are scarce.
  const Vec3 normal =
      has_lights ? optimization_barrier(surface.shading_normal) : surface.shading_normal;
  const Vec3 wi =
      (has_lights ? shading_frame<Traits>(normal, surface.dp_du) : frame).to_world(next.wi);
  if constexpr (full) {
    if (asks)
      value.f *= map_visibility(surface, incident.wi, dot(incident.wi, surface.shading_normal));
    next.weight *= map_visibility(surface, wi, next.wi.z);
  }
  if constexpr (has_lights) {
    path.bsdf_pdf = asks && !next.is_delta() ? next.pdf : PathState::delta_distribution;
    if constexpr (Policy::aims) {
      result.shadow.radiance = direct_radiance(path, incident, value, mis);
    } else {
      result.shadow = ask_light<Traits>(path, surface, from, incident, value, mis);
    }
    if constexpr (Traits::has_media) {
      result.shadow.medium_id =
          scene.media.behind(boundary, incident.wi, surface.point.normal, path.medium.id);
    }
    set_lanes(result.shadow.ray, lanes_of(ray).of_shadow_ray());
    if (!is_black(result.shadow.radiance)) ++path.shadow_rays;
  }
  path.beta *= next.weight;
  if (settings.is_roulette(path.rays)) play_roulette(path.beta, choice, next.eta_scale);
  result.alive = !is_black(path.beta);
  result.ray = spawn_ray(surface.point, normalize(wi));
  if constexpr (Traits::has_media) {
    path.medium.id =
        scene.media.behind(boundary, result.ray.direction, surface.point.normal, path.medium.id);
    path.medium.travelled = 0.0f;
  }
  set_lanes(result.ray, lanes_of(scene).at(path.rays));
  return result;
}

/// As surface_scattering, on the CPU alone: compiled once (any_structure.cpp).
template <class Shading>
Scattering surface_scattering_any(const Scene& scene, const Ray& ray, const Hit& hit,
                                  PathState& path, const PathSettings& settings,
                                  const EagerShading& policy);

/// surface_scattering, or where kernels are for any structure the one that they share.
template <class Traits, class Policy>
PT_HD_IN_KERNEL Scattering scatter_at_surface(const Scene& scene, const Ray& ray, const Hit& hit,
                                              PathState& path, const PathSettings& settings,
                                              const Policy& policy) {
  if constexpr (Traits::accel == Accel::any)
    return surface_scattering_any<ShadingTraits<Traits>>(scene, ray, hit, path, settings, policy);
  else
    return surface_scattering<Traits>(scene, ray, hit, path, settings, policy);
}

}  // namespace pt
