// Masks: stochastic opacity. Whether a ray hits a triangle whose opacity is below 1.
//
// The decision is a function of the ray and the triangle: a hash of the path's id, the index of the
// ray in the path, the triangle and its instance, and not of the ray's floats. So traversal may
// test the triangle in any order, modes agree, and over many paths a mask of opacity a lets 1 - a
// of them through, independently of other triangles.
#pragma once

#include "common/accel/triangle_query.h"
#include "common/sampling/random.h"
#include "common/scene/data/scene.h"
#include "common/texture/sample_texture.h"
#include "common/transport/shutter_time.h"

namespace pt {

inline std::uint32_t mask_seed(std::uint64_t seed) {
  return combine_hash(static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32));
}

/// A path's hash, from which its rays' keys and its free flights derive; 0 in scenes with neither
/// masks nor media.
template <class Traits>
PT_HD std::uint32_t path_hash(const Scene& scene, const PathId& id) {
  if constexpr (!Traits::has_masks && !Traits::has_media) return 0;
  return combine_hash(combine_hash(scene.mask_seed, id.pixel), id.sample);
}

/// The key of the ray after `rays_traced` others of the path, or of the shadow ray from where the
/// last them ended. In a scene with surfaces that camera rays do not hit, the last bit marks camera
/// rays.
PT_HD std::uint32_t next_ray_key(const Scene& scene, std::uint32_t path_key,
                                 std::uint32_t rays_traced) {
  const std::uint32_t key = combine_hash(path_key, 2 * rays_traced);
  return scene.camera.is_limited ? (key & ~1u) | (rays_traced == 0 ? 1u : 0u) : key;
}
PT_HD std::uint32_t shadow_ray_key(const Scene& scene, std::uint32_t path_key,
                                   std::uint32_t rays_traced) {
  const std::uint32_t key = combine_hash(path_key, 2 * rays_traced + 1);
  return scene.camera.is_limited ? key & ~1u : key;
}
template <class SceneOrMasks>
PT_HD bool is_limited_camera_ray(const SceneOrMasks& scene, std::uint32_t ray_key) {
  return scene.camera.is_limited && (ray_key & 1u) != 0;
}

/// How far along the path's next ray a hit may lie: for camera rays up to the far plane, which
/// moves with the camera.
template <bool has_motion = false>
PT_HD float ray_length(const Scene& scene, const Vec3& direction, std::uint32_t ray_key,
                       float time = 0.0f) {
  if (!is_limited_camera_ray(scene, ray_key)) return infinite_distance;
  if constexpr (has_motion) return camera_at(scene, time).distance_in_view(direction);
  return scene.camera.distance_in_view(direction);
}

/// What of a scene decides about masks, by the scene's names.
struct MaskView {
  const Opacity* opacities;
  const CornerAttributes* corners;
  const Texture* textures;
  const std::byte* texels;
  struct {
    bool is_limited;
  } camera;

  PT_HD explicit MaskView(const Scene& scene)
      : opacities(scene.opacities),
        corners(scene.corners),
        textures(scene.textures),
        texels(scene.texels),
        camera{scene.camera.is_limited} {}
};

template <class SceneOrMasks>
PT_HD float opacity_at(const SceneOrMasks& scene, const Opacity& opacity, const Vec2& uv) {
  if (opacity.texture == no_texture) return opacity.offset;
  const Color c = sample_texture(scene.textures, opacity.texture, scene.texels, uv);
  return fused_multiply_add(opacity.scale, grey_of(c), opacity.offset);
}

/// Whether the ray passes the triangle that it intersects at (b1, b2). `instance_index` gives the
/// instance's InstanceRecord::index, 0 in scenes without instances.
template <class SceneOrMasks, class InstanceIndex>
PT_HD bool passes_mask(const SceneOrMasks& scene, std::uint32_t ray_key, const Triangle& triangle,
                       float b1, float b2, InstanceIndex&& instance_index) {
  const Opacity opacity = load_wide(&scene.opacities[triangle.material]);
  if (opacity.hides_from_camera() && is_limited_camera_ray(scene, ray_key)) return true;
  Vec2 uv(b1, b2);
  if ((triangle.attributes & TriangleAttributes::uvs) != 0) {
    uv = load_wide(&scene.corners[triangle.id]).uv_at(Vec3(1.0f - b1 - b2, b1, b2));
  }
  const float there = opacity_at(scene, opacity, uv);
  if (opacity.cutoff > 0.0f) return !(there >= opacity.cutoff);
  return !(to_unit_float(combine_hash(combine_hash(ray_key, triangle.id), instance_index())) <
           there);
}

/// What MaskedQuery needs of triangles.
struct MaskTest {
  const Scene& scene;
  std::uint32_t ray_key;

  PT_HD bool hides(const Triangle& triangle, const TriangleHit& hit, std::uint32_t instance) const {
    return passes_mask(scene, ray_key, triangle, hit.b1, hit.b2, [&] {
      return scene.triangles.instance_count > 0 ? scene.triangles.instances[instance].index : 0;
    });
  }
};

/// Not part of the tracer's loop, which has no register to spare: masks are rare. `slot`: of a
/// triangle in a scene without instances. All by value: a pointer to a kernel's parameters would be
/// a generic address, which compute-sanitizer takes for an invalid one.
PT_NOINLINE inline bool mask_hides(MaskView masks, const Triangle* triangles, std::uint32_t ray_key,
                                   std::uint32_t slot, float b1, float b2) {
  return passes_mask(masks, ray_key, load_wide(&triangles[slot]), b1, b2, [] { return 0u; });
}

/// The same where the triangle is at hand (JudgingQuery of trace_optix), also of an instance.
PT_NOINLINE inline bool judged_mask_hides(MaskView masks, std::uint32_t ray_key, Triangle triangle,
                                          float b1, float b2, std::uint32_t instance_index) {
  return passes_mask(masks, ray_key, triangle, b1, b2, [=] { return instance_index; });
}

}  // namespace pt
