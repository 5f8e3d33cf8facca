// A material made of others becomes one BSDF: which one is chosen by the side of the surface and by
// a random number, and normal and bump maps perturb the normal. Light sampling and BSDF sampling
// then see the same BSDF, so both remain estimates of its integral, and the mean over the choice is
// the blend.
//
// Maps do as Mitsuba 3's: a perturbed normal that faces away from the viewer is tilted the other
// way instead (Schuessler et al. 2017, 'Microfacet-based normal mapping for robust Monte
// Carlo path tracing'), a direction on different sides of the perturbed and the original
// normal carries nothing, so that light does not leak through the surface, and one that nearly does
// is shadowed (Conty Estevez et al. 2019, 'A microfacet-based shadowing function to solve the bump
// terminator problem').
#pragma once

#include "common/math/transform.h"
#include "common/texture/sample_texture.h"
#include "common/transport/surface.h"

namespace pt {

/// The tangent, its partner and the normal that a map's values refer to. From behind, where a
/// two-sided material turns the normal, the others stay.
struct MapFrame {
  Vec3 s, t, n;
};

PT_HD MapFrame map_frame(const Surface& surface, bool turned) {
  const Frame frame = make_frame(surface.shading_normal, surface.dp_du);
  return {frame.tangent, turned ? -frame.bitangent : frame.bitangent, frame.normal};
}

/// The normal of a normal map, or of a bump map, in the frame; not of unit length.
PT_HD Vec3 mapped_normal(const Texture* textures, const std::byte* texels, const Surface& surface,
                         const MapFrame& frame, const Parameter& map) {
  if (surface.material.node == MaterialNode::bump_map) {
    const Vec2 slope = map.value.x * texture_gradient(textures[map.texture], texels, surface.uv);
    const auto along = [&](const Vec3& dp, float height) {
      return Vec3(dot(frame.s, dp), dot(frame.t, dp), height);
    };
    const Vec3 n = glm::cross(along(surface.dp_du, slope.x), along(surface.dp_dv, slope.y));
    return n.z < 0.0f ? -n : n;
  }
  Vec3 n = 2.0f * sample_texture(textures, map.texture, texels, surface.uv) - Vec3(1.0f);
  if (surface.material.node == MaterialNode::gltf_normal_map) {
    n.x *= map.value.x, n.y *= map.value.x;
    if (dot(frame.t, surface.dp_dv) < 0.0f) n.y = -n.y;
  }
  return n;
}

/// What a map makes of a shading normal. `base`: the normal before; `roughness2` as
/// Surface::map_roughness2.
struct TurnedNormal {
  Vec3 normal, base;
  float roughness2;
};

/// Perturbs the shading normal by the surface's material, a map. `wo` points away from the surface.
/// Not inlined, and by value, since maps are few and their code is long.
PT_NOINLINE inline TurnedNormal turned_normal(Surface surface, Parameter map,
                                              const Texture* textures, const std::byte* texels,
                                              Vec3 wo, bool turned) {
  const TurnedNormal unturned = {surface.shading_normal, surface.base_normal,
                                 surface.map_roughness2};
  if (map.texture == no_texture) return unturned;
  const MapFrame frame = map_frame(surface, turned);
  const Vec3 n = mapped_normal(textures, texels, surface, frame, map);
  const float length2 = dot(n, n);
  if (!(length2 > 0.0f)) return unturned;
  const Vec3 local = normalize(n);
  const auto world = [&frame](const Vec3& v) {
    return normalize(weighted_sum(v, frame.s, frame.t, frame.n));
  };
  Vec3 normal = world(local);
  if (map.value.z == 0.0f && dot(wo, normal) * dot(wo, frame.n) < 0.0f) {
    normal = world({-local.x, -local.y, local.z});
  }
  const float tangent2 = fused_multiply_add(-local.z, local.z, 1.0f) / (local.z * local.z);
  return {normal, frame.n,
          map.value.y == 0.0f ? fminf(fmaxf(0.125f * tangent2, 0.0f), 1.0f) : 0.0f};
}

/// One of the two materials of a blend, and a random number that is again uniform in [0, 1).
PT_HD std::uint32_t choose_blended(const Scene& scene, const Surface& surface, float& u) {
  const Parameter p = load_wide(&scene.parameters[surface.material_index]);
  const float weight =
      fminf(fmaxf(grey_of(textured_noinline(scene, p.value, p.texture, surface.uv)), 0.0f), 1.0f);
  const bool second = u < weight;
  u = fminf(second ? u / weight : (u - weight) / (1.0f - weight), one_minus_ulp);
  return second ? surface.material.second : surface.material.first();
}

/// Makes the surface's material a BSDF as seen from `wo`. Takes from `u`, uniform in [0, 1), the
/// choice among blended materials; what is left is uniform again.
PT_HD void resolve_material(const Scene& scene, const Vec3& wo, float& u, Surface& surface) {
  bool turned = false;
  while (surface.material.is(Material::nested)) {
    std::uint32_t next = surface.material.first();
    if (surface.material.node == MaterialNode::two_sided) {
      if (dot(wo, surface.shading_normal) < 0.0f) {
        surface.shading_normal = -surface.shading_normal;
        turned = !turned;
        next = surface.material.second;
      }
    } else if (surface.material.node == MaterialNode::blend) {
      next = choose_blended(scene, surface, u);
    } else {
      const TurnedNormal map =
          turned_normal(surface, load_wide(&scene.parameters[surface.material_index]),
                        scene.textures, scene.texels, wo, turned);
      surface.shading_normal = map.normal;
      surface.base_normal = map.base;
      surface.map_roughness2 = map.roughness2;
    }
    surface.material_index = next;
    surface.material = scene.material(next);
  }
}

/// The shadowing of a map along `wi`, whose cosine about the perturbed normal is `cos_theta`.
PT_HD float map_visibility(const Surface& surface, const Vec3& wi, float cos_theta) {
  if (surface.map_roughness2 < 0.0f) return 1.0f;  // no map
  const float base = dot(wi, surface.base_normal);
  if (!(base * cos_theta > 0.0f)) return 0.0f;
  const float tangent2 = fmaxf(1.0f / (base * base) - 1.0f, 0.0f);
  return 2.0f / (1.0f + fast_sqrt(fused_multiply_add(surface.map_roughness2, tangent2, 1.0f)));
}

}  // namespace pt
