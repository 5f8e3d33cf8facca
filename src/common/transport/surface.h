// What a path finds at the surface that it met: where, how it is turned, of which material.
#pragma once

#include "common/accel/triangle_query.h"
#include "common/scene/scene.h"
#include "common/texture/sample_texture.h"
#include "common/transport/path.h"

namespace pt {

struct Surface {
  SurfacePoint point;
  Vec3 shading_normal;
  Material material;  ///< its colours multiplied by its textures
};

template <class Traits>
PT_HD bool is_placed(const Scene& scene) {
  return Traits::has_instances && scene.triangles.instance_count > 0;
}

/// Where a triangle's point lies in textures: by its vertices' coordinates, or by barycentric ones
/// where it has none.
PT_HD Vec2 texture_coordinates(const Scene& scene, std::uint32_t triangle_id, bool has_uvs,
                               const Vec3& barycentric) {
  return has_uvs ? scene.attributes.uv(triangle_id, barycentric)
                 : Vec2(barycentric.y, barycentric.z);
}

PT_HD void apply_textures(const Scene& scene, const Triangle& triangle, const Vec3& barycentric,
                          Material& material) {
  const MaterialTextures textures = scene.material_textures[material.textures];
  const bool has_uvs = (triangle.attributes & TriangleAttributes::uvs) != 0;
  const Vec2 uv = texture_coordinates(scene, triangle.id, has_uvs, barycentric);
  if (textures.albedo != no_texture) {
    material.albedo *= sample_texture(scene.textures[textures.albedo], scene.texels, uv);
  }
  if (textures.emission != no_texture) {
    material.emission *= sample_texture(scene.textures[textures.emission], scene.texels, uv);
  }
}

/// The triangle once more, from its slot: the hit itself keeps only the distance, for the wavefront
/// has to store it. The error bound of the position is that of pbrt-v4, section 6.8.5, doubled, and
/// what the intersection of the ray that leaves may round: on an axis-parallel plane through 0 the
/// first is 0, but not the second.
template <class Traits>
PT_HD Surface triangle_surface(const Scene& scene, const Ray& ray, const Hit& hit) {
  const std::uint32_t slot = hit.primitive - scene.primitives.count();
  const Triangle triangle = load_wide(&scene.triangles.triangles[slot]);
  const bool placed = is_placed<Traits>(scene);
  InstanceRecord instance;
  Ray local = ray;
  if (placed) {
    instance = load_wide(&scene.triangles.instances[hit.instance]);
    local = object_ray(instance, ray);
  }
  const TriangleHit inside = intersect_triangle(make_triangle_ray(local.origin, local.direction),
                                                triangle.v0, triangle.v1, triangle.v2);
  const Vec3 b(1.0f - inside.b1 - inside.b2, inside.b1, inside.b2);
  Vec3 position = weighted_sum(b, triangle.v0, triangle.v1, triangle.v2);
  Vec3 extent = weighted_sum(glm::abs(b), glm::abs(triangle.v0), glm::abs(triangle.v1),
                             glm::abs(triangle.v2));
  // The next intersection rounds relative to where the vertices lie as seen from the new origin.
  Vec3 size = glm::max(glm::max(glm::abs(triangle.v0 - position), glm::abs(triangle.v1 - position)),
                       glm::abs(triangle.v2 - position));
  Vec3 normal = cross_rounded(triangle.v1 - triangle.v0, triangle.v2 - triangle.v0);
  Vec3 shading_normal = (triangle.attributes & TriangleAttributes::normals) != 0
                            ? scene.attributes.normal(triangle.id, b)
                            : normal;
  if (placed) {
    const Affine to_world = load_wide(&scene.to_world[instance.number]);
    position = to_world.point(position);
    extent = to_world.absolute(extent);
    size = to_world.absolute(size);
    normal = instance.to_object.transposed(normal);
    shading_normal = instance.to_object.transposed(shading_normal);
  }
  normal = normalize(normal);
  Surface surface{{position, normal,
                   fused_multiply_add(16.0f * half_ulp, dot(glm::abs(normal), extent),
                                      8.0f * half_ulp * max_abs(size))},
                  normalize(shading_normal),
                  load_wide(&scene.materials[triangle.material])};
  if (surface.material.textures != 0) apply_textures(scene, triangle, b, surface.material);
  return surface;
}

template <class Traits>
PT_HD Surface surface_at(const Scene& scene, const Ray& ray, const Hit& hit) {
  if constexpr (Traits::geometry != Geometry::spheres_and_quads) {
    const bool is_triangle =
        Traits::geometry == Geometry::triangles || hit.primitive >= scene.primitives.count();
    if (is_triangle) return triangle_surface<Traits>(scene, ray, hit);
  }
  const SurfacePoint point = surface_point(scene.primitives, ray, hit);
  return {point, point.normal, scene.material(hit.primitive)};
}

}  // namespace pt
