// Light sampling (next-event estimation): a light, a point on it, and the density of both.
#pragma once

#include "common/light/lights.h"
#include "common/transport/surface.h"

namespace pt {

/// A primitive that emits, chosen uniformly (Lighting::emitters).
PT_HD IncidentLight sample_emitter(const Scene& scene, const Vec3& from, const Vec4& u) {
  const float count = static_cast<float>(scene.light_count);
  const std::uint32_t wanted = static_cast<std::uint32_t>(u.z * count);
  const std::uint32_t choice = wanted < scene.light_count ? wanted : scene.light_count - 1;
  const Color Le = load_wide(&scene.emissions[scene.light_emission[choice]]).radiance;
  const LightSample light =
      sample_primitive(scene.primitives, scene.lights[choice], from, u.x, u.y);
  return {light.wi, light.end, Le, light.pdf / count};
}

PT_HD float emitter_pdf(const Scene& scene, const Ray& ray, const Hit& hit) {
  return primitive_pdf(scene.primitives, hit.primitive, ray.origin, ray.direction, hit.t) /
         static_cast<float>(scene.light_count);
}

PT_HD PlainLight sample_triangle_light(const Scene& scene, const TriangleLight& light,
                                       const Vec3& from, float u0, float u1) {
  const TriangleLightSample s =
      sample_triangle(light.vertex, light.edge1, light.edge2, light.error(), from, u0, u1);
  PlainLight result = {{s.light.wi, s.light.end, light.radiance, s.light.pdf}};
  if (light.emission_texture != no_texture) {
    Vec3 b(1.0f - s.point.b1 - s.point.b2, s.point.b1, s.point.b2);
    if (light.kind == LightKind::flipped_triangle) b = {b.x, b.z, b.y};
    result.uv = texture_coordinates(scene, light.triangle, light.triangle != no_texture, b);
  }
  return result;
}

/// Any light but triangles and the environment. Not inlined, and by value: scenes have few of them,
/// and their code is long.
PT_NOINLINE inline PlainLight sample_other_light(Light light, Vec3 from, float u0, float u1) {
  return visit_light(OtherLights{}, light.kind, [&]<class Type>(std::type_identity<Type>) {
    return light.as<Type>().sample(from, u0, u1);
  });
}

/// Any light but the environment.
PT_HD IncidentLight sample_listed_light(const Scene& scene, const Light& light, const Vec3& from,
                                        float u0, float u1) {
  PlainLight plain = is_triangle(light.kind)
                         ? sample_triangle_light(scene, light.as<TriangleLight>(), from, u0, u1)
                         : sample_other_light(light, from, u0, u1);
  IncidentLight& incident = plain.incident;
  incident.radiance = textured_noinline(scene, incident.radiance, light.emission_texture, plain.uv);
  return incident;
}

/// A light of the list; of what moves or deforms, as it lies at `time`.
template <bool has_motion>
PT_HD Light light_at(const Scene& scene, std::uint32_t index, float time) {
  const Light light = load_wide(&scene.light_selector.lights[index]);
  if constexpr (has_motion) {
    const MovingLight moving = scene.motion->light(index);
    if (moving.primitive == MovingLight::none) return light;
    if (!is_triangle(light.kind)) {
      auto sphere = light.as<SphereLight>();
      sphere.center = sphere_at(scene.primitives, moving.primitive, *scene.motion, time).center;
      return Light::of(sphere);
    }
    const Triangle own = triangle_at(scene.triangles, moving.primitive, *scene.motion, time);
    const bool is_flipped = light.kind != LightKind::triangle;
    auto triangle = light.as<TriangleLight>();
    triangle.vertex = own.v0;
    triangle.edge1 = (is_flipped ? own.v2 : own.v1) - own.v0;
    triangle.edge2 = (is_flipped ? own.v1 : own.v2) - own.v0;
    if (moving.instance != MovingLight::none) {
      const Affine to_world = to_world_at<true>(scene, moving.instance, time);
      triangle.vertex = to_world.point(triangle.vertex);
      triangle.edge1 = to_world.vector(triangle.edge1);
      triangle.edge2 = to_world.vector(triangle.edge2);
    }
    return Light::of(triangle);
  }
  return light;
}

/// Any light (Lighting::full), chosen by the selector.
template <bool has_motion>
PT_HD IncidentLight sample_selected_light(const Scene& scene, const Vec3& from, Receiver receiver,
                                          const Vec4& u, float time) {
  const LightChoice choice = scene.light_selector.sample(from, receiver, u.z, u.w);
  if (choice.light == environment_light) {
    const EnvironmentSample s = sample_environment(scene.environment, u.x, u.y, u.w);
    return {s.wi, beyond_scene * s.wi, s.radiance, choice.pmf * s.pdf};
  }
  if (choice.light == no_light) return {};
  const Light light = light_at<has_motion>(scene, choice.light, time);
  IncidentLight incident = sample_listed_light(scene, light, from, u.x, u.y);
  incident.pdf *= choice.pmf;
  return incident;
}

template <class Traits>
PT_HD IncidentLight sample_light(const Scene& scene, const Vec3& from, Receiver receiver,
                                 const Vec4& u, float time = 0.0f) {
  if constexpr (Traits::lighting == Lighting::emitters) return sample_emitter(scene, from, u);
  return sample_selected_light<Traits::has_motion>(scene, from, receiver, u, time);
}

/// LightSelector::pmf, not inlined: few paths hit an emitter, and it is as long as sample().
PT_NOINLINE inline float light_pmf_noinline(LightSelector selector, Vec3 point, Receiver receiver,
                                            std::uint32_t light) {
  return selector.pmf(point, receiver, light);
}

/// The density per solid angle with which sample_light would have sampled the point of an emitter
/// that a ray hit.
template <class Traits>
PT_HD float light_pdf(const Scene& scene, const Ray& ray, Receiver receiver, const Hit& hit,
                      float time = 0.0f) {
  if constexpr (Traits::lighting == Lighting::emitters) {
    return emitter_pdf(scene, ray, hit);
  } else {
    const LightSelector& selector = scene.light_selector;
    if (hit.primitive < scene.primitives.count()) {
      Sphere sphere = load_wide(&scene.primitives.spheres[hit.primitive]);
      if constexpr (Traits::has_motion)
        sphere = sphere_at(scene.primitives, hit.primitive, *scene.motion, time);
      return selector.pmf(ray.origin, receiver, scene.light_map.spheres[hit.primitive]) *
             sphere_solid_angle_pdf(sphere, ray.origin);
    }
    const Triangle& hit_triangle =
        scene.triangles.triangles[hit.primitive - scene.primitives.count()];
    const std::uint32_t instance =
        is_placed<Traits>(scene) ? scene.triangles.instances[hit.instance].index : 0;
    const std::uint32_t light_index = scene.light_map.of_triangle(hit_triangle.id, instance);
    // As it was sampled: in the world, relative to its own first corner.
    const auto light =
        light_at<Traits::has_motion>(scene, light_index, time).template as<TriangleLight>();
    return light_pmf_noinline(selector, ray.origin, receiver, light_index) *
           TriangleSampler(light.vertex - ray.origin, light.edge1, light.edge2)
               .pdf(ray.direction, hit.t);
  }
}

}  // namespace pt
