#include "common/transport/intersect_block.h"

#include "common/accel/trace_cpu/ray_block.h"
#include "common/transport/intersect.h"

namespace pt {
namespace {

template <Accel accel, Geometry geometry>
using Plain = Traits<accel, geometry, Lighting::sky>;

// What no block is made for: instances, and a processor without lanes. Calls function(traits) with
// the traits of one ray.
template <class Function>
auto alone(const BlockTraits& traits, Function&& function) {
  if (traits.has_masks) return function(MaskedRays{});
  if (traits.geometry == Geometry::spheres_and_quads) {
    return function(Plain<Accel::brute, Geometry::spheres_and_quads>{});
  }
  if (traits.accel == Accel::brute) return function(Plain<Accel::brute, Geometry::mixed>{});
  return function(Plain<Accel::cwbvh_avx2, Geometry::mixed>{});
}

// Spheres beside triangles are in a tree.
using PrimitivesBesides = Plain<Accel::bvh2, Geometry::mixed>;

bool has_block(const BlockTraits& traits, const Scene& scene) {
  const bool has_lanes =
      traits.accel == Accel::brute ? brute_block() != nullptr : tree_block() != nullptr;
  return scene.triangles.instance_count == 0 && has_lanes;
}

// As MaskedQuery does, of the ray's own hit.
bool mask_hides_block_ray(const void* scene_of_block, const RayBlock& rays, std::uint32_t i,
                          std::uint32_t slot) {
  const Scene& scene = *static_cast<const Scene*>(scene_of_block);
  const Triangle& triangle = scene.triangles.triangles[slot];
  const Ray ray = rays.ray(i);
  const TriangleHit hit = intersect_triangle(make_triangle_ray(ray.origin, ray.direction),
                                             triangle.v0, triangle.v1, triangle.v2);
  return MaskTest{scene, rays.key[i]}.hides(triangle, hit, 0);
}

}  // namespace

void intersect_closest_block(const BlockTraits& traits, const Scene& scene, RayBlock& rays,
                             Hit* hits) {
  if (!has_block(traits, scene)) {
    for (std::uint32_t i = 0; i < rays.count; ++i) {
      hits[i] = alone(traits, [&](auto plain) {
        return intersect_closest<decltype(plain)>(scene, rays.ray(i), rays.key[i]);
      });
    }
    return;
  }
  const BlockMask mask = {&scene, mask_hides_block_ray};
  std::fill_n(hits, rays.count, Hit());
  std::uint32_t first_number = 0;  // of what the block tests
  HitBlock found;
  if (traits.geometry == Geometry::spheres_and_quads) {
    rays.fill_lanes();
    brute_block()->closest_primitives(scene.primitives, rays, found);
  } else {
    first_number = scene.primitives.count();
    for (std::uint32_t i = 0; i < rays.count && first_number > 0; ++i) {
      hits[i] = traits.has_masks ? closest_primitive_in_view(scene, rays.ray(i), rays.key[i])
                                 : closest_primitive<PrimitivesBesides>(scene, rays.ray(i));
      if (!hits[i].is_miss()) rays.t_max[i] = hits[i].t;
    }
    if (traits.accel == Accel::brute) {
      rays.fill_lanes();
      brute_block()->closest_triangles(scene.triangles, rays, found);
    } else {
      tree_block()->closest(scene.triangles, rays, traits.has_masks ? &mask : nullptr, found);
    }
  }
  for (std::uint32_t i = 0; i < rays.count; ++i) {
    if (found.primitive[i] != no_primitive) {
      hits[i] = {found.t[i], first_number + found.primitive[i], 0};
    }
  }
}

std::uint32_t intersect_shadow_block(const BlockTraits& traits, const Scene& scene,
                                     RayBlock& rays) {
  std::uint32_t occluded = 0;
  if (!has_block(traits, scene)) {
    for (std::uint32_t i = 0; i < rays.count; ++i) {
      const ShadowRay shadow = {rays.ray(i), rays.t_max[i]};
      const bool is_occluded = alone(traits, [&](auto plain) {
        return intersect_shadow<decltype(plain)>(scene, shadow, rays.key[i]);
      });
      occluded |= (is_occluded ? 1u : 0u) << i;
    }
    return occluded;
  }
  if (traits.geometry == Geometry::spheres_and_quads) {
    rays.fill_lanes();
    return brute_block()->any_primitive(scene.primitives, rays);
  }
  for (std::uint32_t i = 0; i < rays.count && scene.primitives.count() > 0; ++i) {
    if (any_primitive<PrimitivesBesides>(scene, rays.ray(i), rays.t_max[i])) {
      occluded |= 1u << i;
      rays.t_max[i] = -1.0f;
    }
  }
  if (traits.accel != Accel::brute) {
    const BlockMask mask = {&scene, mask_hides_block_ray};
    return occluded | tree_block()->any(scene.triangles, rays, traits.has_masks ? &mask : nullptr);
  }
  rays.fill_lanes();
  return occluded | brute_block()->any_triangle(scene.triangles, rays);
}

}  // namespace pt
