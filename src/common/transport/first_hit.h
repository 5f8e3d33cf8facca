// The first hit of a camera ray, from which AOVs are computed. It costs paths nothing: it is a pass
// of its own over their camera rays.
#pragma once

#include "common/math/transform.h"
#include "common/sampling/random.h"
#include "common/transport/generate_camera_path.h"
#include "common/transport/shade_surface.h"
#include "common/transport/travel.h"

namespace pt {

/// The first surface with a BSDF: camera rays go through boundaries of media.
struct FirstHit {
  /// Along the ray, in scene units; of what moves, along that of the middle of the interval.
  float distance = 0.0f;
  /// To the path's collision with a medium before that, if it has one.
  float collision = 0.0f;
  Color transmittance = Color(1.0f);  ///< of the media before the surface; estimated
  Vec3 position = Vec3(0.0f);
  Vec3 normal = Vec3(0.0f);  ///< geometric, outward
  Vec3 shading_normal = Vec3(0.0f);
  Vec2 uv = Vec2(0.0f);  ///< v from a texture's head downwards, as in files
  Color albedo = Color(0.0f);
  Vec2 motion = Vec2(0.0f);  ///< pixels, while the shutter is open; 0 for what leaves the view
  std::uint32_t primitive = no_primitive;  ///< spheres, then quads, then triangles, as loaded
  std::uint32_t instance = no_primitive;
  std::uint32_t material = no_primitive;
};

/// The weight of a direction that the BSDF samples, f |cos| / pdf: its mean is the share of the
/// light that the surface sends back, as seen from the ray (the directional albedo). For a diffuse
/// surface that is its colour. What radiance loses or gains by refraction is left out.
template <class Traits>
PT_HD Color sampled_albedo(const Scene& scene, const Ray& ray, Surface surface, const Vec4& u) {
  float choice = u.w;
  if constexpr (Traits::lighting == Lighting::full) {
    resolve_material(scene, -ray.direction, choice, surface);
  }
  if (Traits::lighting == Lighting::full && surface.material.is(Material::one_sided) &&
      dot(ray.direction, surface.shading_normal) >= 0.0f) {
    return Color(0.0f);
  }
  const Vec3 wo =
      shading_frame<Traits>(surface.shading_normal, surface.dp_du).to_local(-ray.direction);
  Color albedo(0.0f);
  const SurfaceParameters<Traits> parameters(scene, surface);
  visit<typename Traits::BsdfList>(surface.material.kind, parameters, [&](const auto& bsdf) {
    const BsdfSample sample = bsdf.sample(wo, Vec3(u));
    // Beyond a boundary radiance is eta^2 times that before it, in glass or out of it.
    albedo = (sample.eta * sample.eta) * sample.weight;
  });
  return albedo;
}

/// `u` as for the path's first scattering.
template <class Traits>
PT_HD FirstHit first_hit(const Scene& scene, const Ray& ray, const Hit& hit, const Vec4& u,
                         float time = 0.0f) {
  FirstHit first;
  if (hit.is_miss()) return first;
  const Surface surface = surface_at<Traits>(scene, ray, hit, time);
  first.material = surface.material_index;
  first.distance = hit.t;
  first.position = surface.point.position;
  first.normal = surface.point.normal;
  first.shading_normal = surface.shading_normal;
  first.uv = surface.uv;
  first.albedo = sampled_albedo<Traits>(scene, ray, surface, u);
  first.instance = 0;
  const std::uint32_t primitives = scene.primitives.count();
  if (hit.primitive < primitives) {
    first.primitive = scene.primitive_numbers[hit.primitive];
    if constexpr (Traits::lighting == Lighting::full) {
      if (surface.material.is(Material::textured)) first.uv.y = 1.0f - first.uv.y;
    }
    return first;
  }
  if constexpr (Traits::geometry != Geometry::spheres_and_quads) {
    const Triangle triangle = triangle_of<Traits>(scene, hit.primitive - primitives, time);
    first.primitive = primitives + triangle.id;
    if (is_placed<Traits>(scene)) first.instance = scene.triangles.instances[hit.instance].index;
    if (!surface.material.is(Material::textured)) {
      first.uv = triangle_uv<Traits>(scene, ray, hit, triangle, time);
    }
    if ((triangle.attributes & TriangleAttributes::uvs) != 0) first.uv.y = 1.0f - first.uv.y;
  }
  return first;
}

/// What a camera ray hits behind boundaries of media without a BSDF.
struct ViewThroughMedia {
  Ray ray;                ///< from the last of them
  float distance = 0.0f;  ///< from the near plane to there
  Hit hit;
  Color transmittance = Color(1.0f);
  bool collides = false;
  float collision = 0.0f;  ///< distance of the path's collision
};

template <class Traits>
PT_HD ViewThroughMedia look_through_media(const Scene& scene, const Ray& camera_ray,
                                          std::uint32_t path_key, float time = 0.0f) {
  ViewThroughMedia view;
  view.ray = camera_ray;
  PathState path;  // the flights of the path itself: their keys are the same
  for (;; ++path.rays) {
    const std::uint32_t ray_key = next_ray_key(scene, path_key, path.rays);
    view.hit = intersect_closest<Traits>(scene, view.ray, ray_key, time);
    Hit end = view.hit;
    FreeFlight flight;
    travel<Traits::has_sparse>(scene, view.ray, path_key, to_the_end, path, flight, end);
    if (end.is_collision() && !view.collides) {
      view.collides = true, view.collision = view.distance + end.t;
    }
    if (path.medium.id != no_medium) {
      view.transmittance =
          view.transmittance * (estimate_transmittance<Traits::has_sparse>(
                                   scene.grids, load_wide(scene.media.at(path.medium.id)), view.ray,
                                   view.hit.t, combine_hash(ray_key, 1)));
    }
    if (view.hit.is_miss()) return view;
    const std::uint32_t index = material_index_at(scene, view.hit);
    const Material material = scene.material(index);
    if (!lets_through(scene, material, index, path.medium.id) || is_pane(material)) return view;
    const Surface surface = surface_at<ShadingTraits<Traits>>(scene, view.ray, view.hit, time);
    const BoundaryCrossing crossing = cross_boundary(scene, view.ray, surface, path.medium.id);
    path.medium.id = crossing.medium_id;
    view.distance += crossing.length;
    view.ray = crossing.ray;
  }
}

/// How the image of the point that was hit at `time` moves while the shutter is open.
template <class Traits>
PT_HD Vec2 motion_of(const Scene& scene, const Ray& ray, const Hit& hit, const Vec3& position,
                     float time) {
  Vec3 begin = position, end = position;
  if (hit.primitive >= scene.primitives.count()) {
    const std::uint32_t slot = hit.primitive - scene.primitives.count();
    const bool placed = is_placed<Traits>(scene);
    InstanceRecord instance;
    if (placed) instance = instance_at<Traits>(scene, hit.instance, time);
    const Vec3 b = barycentric_at(placed ? object_ray(instance, ray) : ray,
                                  triangle_of<Traits>(scene, slot, time));
    const auto place_at = [&](float then) {
      const Triangle triangle = triangle_of<Traits>(scene, slot, then);
      const Vec3 p = weighted_sum(b, triangle.v0, triangle.v1, triangle.v2);
      return placed ? to_world_at<true>(scene, instance.index, then).point(p) : p;
    };
    begin = place_at(0.0f), end = place_at(1.0f);
  } else if (const Motion& motion = *scene.motion; moves(motion, hit.primitive)) {
    const Vec3 own = inverse(sphere_pose(motion, hit.primitive, time)).point(position);
    begin = sphere_pose(motion, hit.primitive, 0.0f).point(own);
    end = sphere_pose(motion, hit.primitive, 1.0f).point(own);
  }
  Vec2 from, to;
  const bool is_seen = film_position(camera_at(scene, 0.0f), begin, from) &&
                       film_position(camera_at(scene, 1.0f), end, to);
  return is_seen ? to - from : Vec2(0.0f);
}

/// What the camera sees at a time, from the camera on.
template <class Traits>
PT_HD ViewThroughMedia view_at(const Scene& scene, const PathId& id, const Vec4& u, float time) {
  const Camera camera = camera_at(scene, time);
  ViewThroughMedia view;
  view.ray = generate_camera_path(scene, camera, id.pixel, u);
  const float near_plane = camera.distance_of_near_plane(view.ray.direction);
  const std::uint32_t key = path_hash<Traits>(scene, id);
  if constexpr (Traits::has_media) {
    view = look_through_media<Traits>(scene, view.ray, key, time);
  } else {
    view.hit = intersect_closest<Traits>(scene, view.ray, key, time);
  }
  view.distance += near_plane, view.collision += near_plane;
  return view;
}

/// The first hit of the camera ray that the path `id` has.
template <class Traits, class Source>
PT_HD FirstHit first_hit_of_path(const Scene& scene, const Source& source, const PathId& id,
                                 bool& is_negative) {
  auto random = source.open(id);
  const Vec4 u = random.draw(scatter_block(0));
  is_negative = scene.filter.is_negative(u.x, u.y);
  PathState path;
  set_time<Traits>(scene, id, path);
  if constexpr (Traits::has_motion) {
    const ViewThroughMedia own = view_at<Traits>(scene, id, u, path.time);
    FirstHit first = first_hit<ShadingTraits<Traits>>(scene, own.ray, own.hit,
                                                      random.draw(scatter_block(1)), path.time);
    if (!own.hit.is_miss())
      first.motion = motion_of<Traits>(scene, own.ray, own.hit, first.position, path.time);
    first.transmittance = own.transmittance;
    const ViewThroughMedia middle = view_at<Traits>(scene, id, u, 0.5f);
    first.distance = middle.hit.is_miss() ? 0.0f : middle.distance + middle.hit.t;
    first.collision = middle.collides ? middle.collision : first.distance;
    return first;
  }
  Ray ray = generate_camera_path(scene, id.pixel, u);
  const float near_plane = scene.camera.distance_of_near_plane(ray.direction);
  const std::uint32_t key = path_hash<Traits>(scene, id);
  if constexpr (Traits::has_media) {
    ViewThroughMedia view = look_through_media<Traits>(scene, ray, key);
    FirstHit first =
        first_hit<ShadingTraits<Traits>>(scene, view.ray, view.hit, random.draw(scatter_block(1)));
    if (!view.hit.is_miss()) first.distance += near_plane + view.distance;
    first.collision = view.collides ? near_plane + view.collision : first.distance;
    first.transmittance = view.transmittance;
    return first;
  }
  const Hit hit = intersect_closest<Traits>(scene, ray, next_ray_key(scene, key, 0));
  FirstHit first = first_hit<ShadingTraits<Traits>>(scene, ray, hit, random.draw(scatter_block(1)));
  if (!hit.is_miss()) first.distance += near_plane;
  first.collision = first.distance;
  return first;
}

}  // namespace pt
