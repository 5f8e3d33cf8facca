// Between surfaces: a ray in a medium collides or arrives, and what a collision does with a path
// (pbrt-v4, section 14.2). Only in scenes with media (Traits::has_media).
#pragma once

#include "common/medium/free_flight.h"
#include "common/transport/shade_surface.h"

namespace pt {

/// For the free flight of the ray after `rays_traced` others of the path.
PT_HD std::uint32_t flight_key(std::uint32_t path_key, std::uint32_t rays_traced) {
  constexpr std::uint32_t purpose = 0x6d656469u;  // not that of masks
  return combine_hash(combine_hash(path_key, purpose), rays_traced);
}

/// A flight has no end of its own: all of its collisions are sampled at once.
inline constexpr std::uint32_t to_the_end = ~0u;

/// Takes a path's flight in a homogeneous medium to its end. Before the path's first scattering,
/// where single scattering shows, it may be drawn to a light at a point.
PT_HD FlightEvent fly_homogeneous(const Scene& scene, const Color& extinction, const Ray& ray,
                                  float t_max, std::uint32_t key, FreeFlight& flight,
                                  PathState& path) {
  constexpr float share = 0.5f;
  const float u_channel = to_unit_float(combine_hash(key, 0));
  const float u_distance = to_unit_float(combine_hash(key, 1));
  ChannelDensities& densities = path.medium.densities;
  const std::uint32_t lights = scene.light_point_count;
  if (lights > 0 && path.rays == path.medium.interface_crossings && !is_black(extinction)) {
    const float choice = to_unit_float(combine_hash(key, 2)) * static_cast<float>(lights);
    const std::uint32_t light = min_integer(static_cast<std::uint32_t>(choice), lights - 1);
    const Equiangular towards(ray, t_max, Vec3(scene.light_points[light]));
    if (towards.pays()) {
      return fly_homogeneous(extinction, t_max, towards, share, to_unit_float(combine_hash(key, 3)),
                             u_channel, u_distance, flight, densities, path.beta);
    }
  }
  return fly_homogeneous(extinction, t_max, u_channel, u_distance, flight, densities, path.beta);
}

/// Before a flight begins: a camera ray starts in the medium around the camera.
PT_HD void begin_flight(const Scene& scene, PathState& path) {
  if (path.rays > 0) return;
  path.medium = {};
  path.medium.id = static_cast<std::uint16_t>(scene.camera_medium_id);
}

/// Takes a path to the end of its ray, `hit`, or to a collision before, which is then the hit.
/// Multiplies its throughput by what the flight weighs. Returns whether it is there: after
/// `collisions_max` null collisions it is not, and `flight` says where to go on. `path.rays` does
/// not yet count the ray. `has_sparse`: see sample_grid().
template <bool has_sparse = false>
PT_HD bool travel(const Scene& scene, const Ray& ray, std::uint32_t path_key,
                  std::uint32_t collisions_max, PathState& path, FreeFlight& flight, Hit& hit) {
  if (!flight.has_begun()) begin_flight(scene, path);
  if (path.medium.id == no_medium) return true;
  const Medium medium = load_wide(scene.media.at(path.medium.id));
  const std::uint32_t key = flight_key(path_key, path.rays);
  FlightEvent event;
  if (medium.is_homogeneous()) {
    event = fly_homogeneous(scene, medium.extinction, ray, hit.t, key, flight, path);
  } else {
    do {
      lanes_of(ray).count(LanePoint::flight);
      event = fly_to_collision<has_sparse>(scene.grids, medium, ray, hit.t, key, flight,
                                           path.medium.densities, path.beta);
    } while (event == FlightEvent::collides_with_nothing && --collisions_max > 0);
    if (event == FlightEvent::collides_with_nothing) return false;
  }
  if (event == FlightEvent::collides) hit = {flight.t, medium_collision, 0};
  return true;
}

/// The closest hit of a path's next ray, or the collision before it. `flight`: where its flight
/// has got already.
template <class Traits>
PT_HD Hit next_hit(const Scene& scene, const Ray& ray, std::uint32_t path_key, PathState& path,
                   FreeFlight flight = {}) {
  Hit hit =
      intersect_closest<Traits>(scene, ray, next_ray_key(scene, path_key, path.rays), path.time);
  if constexpr (Traits::has_media) {
    travel<Traits::has_sparse>(scene, ray, path_key, to_the_end, path, flight, hit);
  }
  return hit;
}

/// As surface_scattering, for a collision `distance` along the ray: the medium emits, light is
/// sampled, and the phase function decides where the path goes on.
template <class Traits, class Policy>
PT_HD_IN_KERNEL Scattering medium_scattering(const Scene& scene, const Ray& ray, float distance,
                                             PathState& path, const PathSettings& settings,
                                             const Policy& policy) {
  lanes_of(ray).count(LanePoint::shade_medium);
  const Medium medium = load_wide(scene.media.at(path.medium.id));
  const Vec3 point = add_scaled(ray.origin, distance, ray.direction);
  const Color albedo = albedo_at<Traits::has_sparse>(scene.grids, medium, point);
  Scattering result;
  const Color emission =
      emission_at<Traits::has_sparse>(scene.grids, medium, point) * (Color(1.0f) - albedo);
  result.emitted = policy.emit(path.beta * emission);
  if (path.depth<Traits>() >= settings.max_depth || is_black(albedo)) return result;
  path.beta *= albedo;
  path.receiver = {};
  IncidentLight incident;
  if (settings.nee) {
    incident = sample_light<Traits>(scene, point, path.receiver, policy.light(), path.time);
  }
  const Vec4 scatter = policy.scatter();
  BsdfValue value;
  PhaseSample next{};
  visit_phase(medium.phase, medium.phase_parameter, [&](const auto& phase) {
    if (incident.pdf > 0.0f) {
      value.pdf = phase.value(dot(ray.direction, incident.wi));
      value.f = Color(value.pdf);
    }
    next = sample_phase(phase, ray.direction, scatter.x, scatter.y);
  });
  const Color radiance = direct_radiance(path, incident, value, settings.mis);
  const float distance2 = dot(incident.end, incident.end);
  if (!is_black(radiance) && distance2 > 0.0f) {
    const float inverse = inverse_sqrt(distance2);
    result.shadow = {
        {point, incident.end * inverse}, distance2 * inverse, radiance, path.medium.id};
    set_lanes(result.shadow.ray, lanes_of(ray).of_shadow_ray());
    ++path.shadow_rays;
  }
  path.bsdf_pdf = settings.nee ? next.pdf : PathState::delta_distribution;
  path.medium.travelled = 0.0f;
  if (settings.is_roulette(path.rays)) play_roulette(path.beta, scatter.w);
  result.alive = !is_black(path.beta);
  result.ray = {point, next.wi};
  set_lanes(result.ray, lanes_of(scene).at(path.rays));
  return result;
}

/// The transmittance of one segment of a shadow ray, of this length in one medium; `segment` is its
/// number.
template <bool has_sparse = false>
PT_HD Color segment_transmittance(const Scene& scene, std::uint16_t medium_id, const Ray& ray,
                                  float length, std::uint32_t ray_key, std::uint32_t segment) {
  return estimate_transmittance<has_sparse>(scene.grids, load_wide(scene.media.at(medium_id)), ray,
                                            length, flight_key(ray_key, segment));
}

/// The transmittance along a shadow ray: black if a surface with a BSDF lies between its ends, else
/// that of the media and panes through which it goes.
template <class Traits>
PT_HD Color shadow_transmittance(const Scene& scene, const ShadowRay& shadow, std::uint32_t ray_key,
                                 float time = 0.0f) {
  if constexpr (Traits::has_motion) {  // whose kernels with masks know media in any case
    if (!scene.media.are_present)
      return Color(intersect_shadow<Traits>(scene, shadow, ray_key, time) ? 0.0f : 1.0f);
  }
  Color result(1.0f);
  Ray ray = shadow.ray;
  float left = shadow.distance;
  std::uint16_t medium_id = shadow.medium_id;
  for (std::uint32_t segment = 0;; ++segment) {
    const Hit hit = intersect_closest<Traits>(scene, ray, ray_key, time);
    const bool arrives = hit.is_miss() || !(hit.t < left);
    const std::uint32_t material = arrives ? 0 : material_index_at(scene, hit);
    if (!arrives && !lets_through(scene, scene.material(material), material, medium_id)) {
      return Color(0.0f);
    }
    if (medium_id != no_medium) {
      const float length = arrives ? left : hit.t;
      result *= segment_transmittance<Traits::has_sparse>(scene, medium_id, ray, length, ray_key,
                                                          segment);
    }
    if (arrives || is_black(result)) return result;
    const Surface surface = surface_at<ShadingTraits<Traits>>(scene, ray, hit, time);
    if (is_pane(surface.material)) {
      const float cosine = dot(ray.direction, surface.shading_normal);
      result *= pane_at(scene, surface).transmittance(cosine);
    }
    const BoundaryCrossing crossing = cross_boundary(scene, ray, surface, medium_id);
    medium_id = crossing.medium_id;
    left -= crossing.length;
    ray.origin = crossing.ray.origin;
  }
}

}  // namespace pt
