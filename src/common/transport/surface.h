// The surface interaction at a hit: point, normals, derivatives, material (pbrt-v4, section 3.11).
#pragma once

#include "common/accel/triangle_query.h"
#include "common/geometry/primitives.h"
#include "common/scene/data/scene.h"
#include "common/texture/sample_texture.h"
#include "common/transport/path.h"

namespace pt {

struct Surface {
  SurfacePoint point;
  Vec3 shading_normal;
  std::uint32_t material_index;
  Material material;
  Vec2 uv = Vec2(0.0f);  ///< where the material is textured
  // Lighting::full. Derivatives of the point by u and v where the material needs tangents; 0: there
  // are none.
  Vec3 dp_du = Vec3(0.0f), dp_dv = Vec3(0.0f);
  Vec3 base_normal = Vec3(0.0f);  ///< the shading normal before a map perturbed it
  float map_roughness2 = -1.0f;   ///< see map_visibility; below 0: no map
};

/// c, multiplied by the texture of this index where there is one.
PT_HD Color textured(const Scene& scene, const Color& c, std::uint32_t texture, const Vec2& uv) {
  if (texture == no_texture) return c;
  return c * sample_texture(scene.textures, texture, scene.texels, uv);
}

/// The same, not inlined: a lookup's code is long, and there would be dozens of it. With one
/// argument less than the table and an index, which callers would have to keep.
PT_NOINLINE inline Color multiply_texture(Color c, const Texture* texture, const std::byte* texels,
                                          Vec2 uv) {
  return c * sample_texture(texture - texture->index, texture->index, texels, uv);
}
PT_HD Color textured_noinline(const Scene& scene, const Color& c, std::uint32_t texture,
                              const Vec2& uv) {
  if (texture == no_texture) return c;
  return multiply_texture(c, &scene.textures[texture], scene.texels, uv);
}

/// What a BSDF makes itself of (bsdf.h): the parameters of a surface's material. The first one is
/// read ahead of the dispatch, for nearly all BSDFs have a colour there: so its texture is looked
/// up by one piece of code, whatever the BSDF.
template <class Traits>
class SurfaceParameters {
 public:
  PT_HD SurfaceParameters(const Scene& scene, const Surface& surface)
      : scene_(scene),
        surface_(surface),
        first_(value_of(load_wide(&scene.parameters[surface.material_index]))) {}

  PT_HD Color color(int i) const { return i == 0 ? first_ : read(i); }
  PT_HD float scalar(int i) const { return color(i).x; }

 private:
  PT_HD Color read(int i) const {
    const Parameter p = load_wide(&scene_.parameters[surface_.material.parameters + (i - 1)]);
    if constexpr (Traits::lighting != Lighting::full) return p.value;
    return textured_noinline(scene_, p.value, p.texture, surface_.uv);
  }

  PT_HD Color value_of(const Parameter& p) const {
    if constexpr (Traits::lighting != Lighting::full) return p.value;
    return textured(scene_, p.value, p.texture, surface_.uv);
  }

  const Scene& scene_;
  const Surface& surface_;
  Color first_;
};

template <class Traits>
PT_HD bool is_placed(const Scene& scene) {
  return Traits::has_instances && scene.triangles.instance_count > 0;
}

/// Where a triangle's point lies in textures: by its vertices' coordinates, or by barycentric ones
/// where it has none.
PT_HD Vec2 texture_coordinates(const Scene& scene, std::uint32_t triangle_id, bool has_uvs,
                               const Vec3& barycentric) {
  return has_uvs ? load_wide(&scene.corners[triangle_id]).uv_at(barycentric)
                 : Vec2(barycentric.y, barycentric.z);
}

/// Sets dp_du and dp_dv of a triangle with texture coordinates; v grows as ours does, upwards.
PT_HD void set_derivatives(const Triangle& triangle, const CornerAttributes& corners,
                           const Affine* to_world, Surface& surface) {
  const Vec2 uv1 = corners.uv[1] - corners.uv[0], uv2 = corners.uv[2] - corners.uv[0];
  const float determinant = difference_of_products(uv1.x, uv2.y, uv1.y, uv2.x);
  if (determinant == 0.0f) return;
  const float scale = 1.0f / determinant;
  const Vec3 edge1 = triangle.v1 - triangle.v0, edge2 = triangle.v2 - triangle.v0;
  const auto combine = [&](float a, float b) {
    const Vec3 sum = weighted_sum(scale * Vec3(a, b, 0.0f), edge1, edge2, Vec3(0.0f));
    return to_world != nullptr ? to_world->vector(sum) : sum;
  };
  surface.dp_du = combine(uv2.y, -uv1.y);
  surface.dp_dv = combine(-uv2.x, uv1.x);
}

/// The hit point of a ray in the triangle's space.
PT_HD Vec3 barycentric_at(const Ray& local, const Triangle& triangle) {
  const TriangleHit inside = intersect_triangle(make_triangle_ray(local.origin, local.direction),
                                                triangle.v0, triangle.v1, triangle.v2);
  return {1.0f - inside.b1 - inside.b2, inside.b1, inside.b2};
}

/// The instance of a hit, and a triangle; at `time`, where they move.
template <class Traits>
PT_HD InstanceRecord instance_at(const Scene& scene, std::uint32_t instance, float time) {
  const InstanceRecord record = load_wide(&scene.triangles.instances[instance]);
  if constexpr (Traits::has_motion) return placed_at(record, *scene.motion, time);
  return record;
}
template <class Traits>
PT_HD Triangle triangle_of(const Scene& scene, std::uint32_t slot, float time) {
  if constexpr (Traits::has_motion) return triangle_at(scene.triangles, slot, *scene.motion, time);
  return load_wide(&scene.triangles.triangles[slot]);
}
template <class Traits>
PT_HD CornerAttributes corners_of(const Scene& scene, std::uint32_t triangle_id, float time) {
  if constexpr (Traits::has_motion) {
    const Motion& motion = *scene.motion;
    if (motion.corners.count > 0) {
      const VertexTime at = vertex_time(time, motion.vertex_steps);
      CornerAttributes corners = motion.corners.of(scene.corners, at.set, triangle_id);
      const CornerAttributes end = motion.corners.of(scene.corners, at.set + 1, triangle_id);
      for (int i = 0; i < 3; ++i)
        corners.normal[i] = interpolate(corners.normal[i], end.normal[i], at.part);
      return corners;
    }
  }
  return load_wide(&scene.corners[triangle_id]);
}
template <bool has_motion>
PT_HD Affine to_world_at(const Scene& scene, std::uint32_t index, float time) {
  if constexpr (has_motion) {
    if (scene.motion->instances[index].moves()) return scene.motion->to_world(index, time);
  }
  return load_wide(&scene.to_world[index]);
}

/// Where a ray that hit the triangle lies in textures, whether its material has one or not.
template <class Traits>
PT_HD Vec2 triangle_uv(const Scene& scene, const Ray& ray, const Hit& hit, const Triangle& triangle,
                       float time = 0.0f) {
  const Ray local = is_placed<Traits>(scene)
                        ? object_ray(instance_at<Traits>(scene, hit.instance, time), ray)
                        : ray;
  const Vec3 b = barycentric_at(local, triangle);
  const bool has_uvs = (triangle.attributes & TriangleAttributes::uvs) != 0;
  return texture_coordinates(scene, triangle.id, has_uvs, b);
}

/// The triangle once more, from its slot: the hit itself keeps only the distance, for the wavefront
/// has to store it. The error bound of the position is that of pbrt-v4, section 6.8.5, doubled, and
/// what the intersection of the ray that leaves may round: on an axis-parallel plane through 0 the
/// first is 0, but not the second.
template <class Traits>
PT_HD Surface triangle_surface(const Scene& scene, const Ray& ray, const Hit& hit,
                               float time = 0.0f) {
  const std::uint32_t slot = hit.primitive - scene.primitives.count();
  const Triangle triangle = triangle_of<Traits>(scene, slot, time);
  const bool has_uvs = (triangle.attributes & TriangleAttributes::uvs) != 0;
  const bool has_normals = (triangle.attributes & TriangleAttributes::normals) != 0;
  CornerAttributes corners;
  if (has_uvs || has_normals) corners = corners_of<Traits>(scene, triangle.id, time);
  const Material material = scene.material(triangle.material);
  const bool placed = is_placed<Traits>(scene);
  InstanceRecord instance;
  Ray local = ray;
  if (placed) {
    instance = instance_at<Traits>(scene, hit.instance, time);
    local = object_ray(instance, ray);
  }
  const Vec3 b = barycentric_at(local, triangle);
  Vec3 position = weighted_sum(b, triangle.v0, triangle.v1, triangle.v2);
  Vec3 extent = weighted_sum(glm::abs(b), glm::abs(triangle.v0), glm::abs(triangle.v1),
                             glm::abs(triangle.v2));
  // The next intersection rounds relative to where the vertices lie as seen from the new origin.
  Vec3 size = glm::max(glm::max(glm::abs(triangle.v0 - position), glm::abs(triangle.v1 - position)),
                       glm::abs(triangle.v2 - position));
  Vec3 normal = glm::cross(triangle.v1 - triangle.v0, triangle.v2 - triangle.v0);
  Vec3 shading_normal = has_normals ? corners.normal_at(b) : normal;
  if (placed) {
    const Affine to_world = to_world_at<Traits::has_motion>(scene, instance.index, time);
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
                  triangle.material,
                  material};
  if (surface.material.is(Material::textured)) {
    surface.uv = has_uvs ? corners.uv_at(b) : Vec2(b.y, b.z);
  }
  if constexpr (Traits::lighting == Lighting::full) {
    if (surface.material.is(Material::tangents) && has_uvs) {
      if constexpr (Traits::has_motion) {
        const Affine to_world = placed ? to_world_at<true>(scene, instance.index, time) : Affine();
        set_derivatives(triangle, corners, &to_world, surface);
      } else {
        set_derivatives(triangle, corners, placed ? &scene.to_world[instance.index] : nullptr,
                        surface);
      }
    }
  }
  return surface;
}

/// The material that a ray hit.
PT_HD std::uint32_t material_index_at(const Scene& scene, const Hit& hit) {
  const std::uint32_t primitives = scene.primitives.count();
  return hit.primitive < primitives
             ? scene.material_of[hit.primitive]
             : scene.triangles.triangles[hit.primitive - primitives].material;
}

PT_HD Surface in_frame(const SphereFrame& frame, float radius, Surface surface) {
  const Vec3 local = frame.local(surface.point.normal);
  if (surface.material.is(Material::textured)) surface.uv = sphere_uv(local);
  if (surface.material.is(Material::tangents)) {
    surface.dp_du = sphere_dp_du(frame, local, radius);
    surface.dp_dv = sphere_dp_dv(frame, local, radius);
  }
  surface.point.normal = surface.shading_normal = frame.side * surface.point.normal;
  return surface;
}

/// A sphere in a scene of which some have a frame. Not inlined, since few scenes have any; and
/// called with values alone: the scene, a kernel's parameter, would be handed on in local memory,
/// which gives the kernel that shades all scenes with instances 800 bytes of stack instead of 72.
PT_NOINLINE inline Surface framed_sphere(const SphereFrame* its_frame, float radius,
                                         Surface surface) {
  return in_frame(load_wide(its_frame), radius, surface);
}
/// `motion` is that of a scene whose sphere `i` moves; its frame is in its own space.
PT_NOINLINE inline Surface moving_framed_sphere(const SphereFrame* its_frame, float radius,
                                                Surface surface, const Motion* motion,
                                                std::uint32_t i, float time) {
  SphereFrame frame = load_wide(its_frame);
  frame.turn(sphere_pose(*motion, i, time));
  return in_frame(frame, radius, surface);
}

template <class Traits>
PT_HD Surface surface_at(const Scene& scene, const Ray& ray, const Hit& hit, float time = 0.0f) {
  if constexpr (Traits::geometry != Geometry::spheres_and_quads) {
    const bool is_triangle =
        Traits::geometry == Geometry::triangles || hit.primitive >= scene.primitives.count();
    if (is_triangle) return triangle_surface<Traits>(scene, ray, hit, time);
  }
  SurfacePoint point;
  if constexpr (Traits::has_motion) {
    point =
        sphere_surface(sphere_at(scene.primitives, hit.primitive, *scene.motion, time), ray, hit.t);
  } else {
    point = surface_point(scene.primitives, ray, hit);
  }
  const std::uint32_t material = scene.material_of[hit.primitive];
  const Surface surface = {point, point.normal, material, scene.material(material)};
  if constexpr (Traits::lighting == Lighting::full) {  // where there are no quads
    if (scene.sphere_frames != nullptr) {
      if constexpr (Traits::has_motion) {
        if (moves(*scene.motion, hit.primitive))
          return moving_framed_sphere(&scene.sphere_frames[hit.primitive],
                                      scene.primitives.spheres[hit.primitive].radius(), surface,
                                      scene.motion, hit.primitive, time);
      }
      return framed_sphere(&scene.sphere_frames[hit.primitive],
                           scene.primitives.spheres[hit.primitive].radius(), surface);
    }
  }
  return surface;
}

}  // namespace pt
