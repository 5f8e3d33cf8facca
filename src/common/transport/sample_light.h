// One light is asked what it sends to a point, and how likely it was to be asked.
#pragma once

#include "common/light/area_light.h"
#include "common/light/delta_light.h"
#include "common/light/triangle_light.h"
#include "common/transport/surface.h"

namespace pt {

/// What a light sends to a point, if nothing lies between.
struct IncidentLight {
  Vec3 wi = Vec3(0.0f);
  Vec3 end = Vec3(0.0f);         ///< of a shadow ray, relative to its origin
  Color radiance = Color(0.0f);  ///< of a delta light: radiance times density
  float pdf = 0.0f;              ///< per solid angle, of light and direction; 0: nothing arrives
  bool is_delta = false;         ///< no BSDF sample could have found it
};

/// A primitive that emits, chosen uniformly (Lighting::emitters).
PT_HD IncidentLight sample_emitter(const Scene& scene, const Vec3& from, const Vec4& u) {
  const float count = static_cast<float>(scene.light_count);
  const std::uint32_t choice = static_cast<std::uint32_t>(u.z * count);
  const std::uint32_t primitive =
      scene.lights[choice < scene.light_count ? choice : scene.light_count - 1];
  const LightSample light = sample_primitive(scene.primitives, primitive, from, u.x, u.y);
  return {light.wi, light.end, scene.material(primitive).emission, light.pdf / count};
}

PT_HD float emitter_pdf(const Scene& scene, const Ray& ray, const Hit& hit) {
  return primitive_pdf(scene.primitives, hit.primitive, ray.origin, ray.direction, hit.t) /
         static_cast<float>(scene.light_count);
}

PT_HD Color textured_radiance(const Scene& scene, const Light& light, const Vec3& barycentric) {
  if (light.emission_texture == no_texture) return light.radiance;
  const bool has_uvs = light.triangle != no_texture;
  const Vec2 uv = texture_coordinates(scene, light.triangle, has_uvs, barycentric);
  return light.radiance * sample_texture(scene.textures[light.emission_texture], scene.texels, uv);
}

/// Any light but the environment.
PT_HD IncidentLight sample_listed_light(const Scene& scene, const Light& light, const Vec3& from,
                                        float u0, float u1) {
  if (light.kind <= LightKind::turned_triangle) {
    const TriangleLightSample s =
        sample_triangle(light.a, light.b, light.c, light.error(), from, u0, u1);
    Vec3 b(1.0f - s.point.b1 - s.point.b2, s.point.b1, s.point.b2);
    if (light.kind == LightKind::turned_triangle) b = {b.x, b.z, b.y};
    return {s.light.wi, s.light.end, textured_radiance(scene, light, b), s.light.pdf};
  }
  if (light.kind == LightKind::sphere) {
    const LightSample s = sample_sphere({light.a, light.c.x}, from, u0, u1);
    return {s.wi, s.end, light.radiance, s.pdf};
  }
  const DeltaLightSample s = sample_delta_light(light.delta(), from);
  return {s.wi, s.end, s.irradiance, 1.0f, true};
}

PT_HD IncidentLight sample_light(const Scene& scene, const Vec3& from, const Vec4& u) {
  const LightList& list = scene.light_list;
  const float p = list.environment_probability;
  if (u.z < p) {
    const EnvironmentSample s = sample_environment(scene.environment, u.x, u.y, u.w);
    return {s.wi, beyond_scene * s.wi, s.radiance, p * s.pdf};
  }
  if (list.count == 0) return {};
  const AliasSample choice = sample_alias(list.selection, list.count, (u.z - p) / (1.0f - p), u.w);
  const Light light = load_wide(&list.lights[choice.index]);
  IncidentLight incident = sample_listed_light(scene, light, from, u.x, u.y);
  incident.pdf *= list.probability(light.weight);
  return incident;
}

/// Twice the area of a triangle times its normal, in the world: from its edges as list_lights() has
/// them, which do not know where the instance lies.
template <class Traits>
PT_HD Vec3 world_normal(const Scene& scene, const Triangle& triangle, std::uint32_t instance) {
  Vec3 edge1 = triangle.v1 - triangle.v0, edge2 = triangle.v2 - triangle.v0;
  if (is_placed<Traits>(scene)) {
    const Affine to_world = load_wide(&scene.to_world[scene.triangles.instances[instance].number]);
    edge1 = to_world.vector(edge1), edge2 = to_world.vector(edge2);
  }
  return cross_rounded(edge1, edge2);
}

/// The density with which sample_light would have found the surface that a ray hit.
template <class Traits>
PT_HD float light_pdf(const Scene& scene, const Ray& ray, const Hit& hit) {
  if constexpr (Traits::lighting == Lighting::emitters) {
    return emitter_pdf(scene, ray, hit);
  } else {
    if (hit.primitive < scene.primitives.count()) {
      const Sphere sphere = load_wide(&scene.primitives.spheres[hit.primitive]);
      return scene.light_list.probability(
                 emitter_weight(scene.material(hit.primitive).emission, sphere_area(sphere))) *
             sphere_solid_angle_pdf(sphere, ray.origin);
    }
    const Triangle t =
        load_wide(&scene.triangles.triangles[hit.primitive - scene.primitives.count()]);
    const Vec3 normal = world_normal<Traits>(scene, t, hit.instance);
    const Material& material = scene.materials[t.material];
    const float mean = scene.material_textures[material.textures].emission_mean;
    // The side is the caller's affair: in an instance that mirrors, this normal is turned.
    const float side = dot(normal, ray.direction) > 0.0f ? -1.0f : 1.0f;
    return scene.light_list.probability(
               emitter_weight(material.emission, 0.5f * glm::length(normal), mean)) *
           triangle_solid_angle_pdf(side * normal, ray.direction, hit.t);
  }
}

}  // namespace pt
