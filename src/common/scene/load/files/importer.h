// What the importers of all formats share about materials, shapes, cameras and lights.
#pragma once

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <utility>
#include <vector>

#include "common/math/transform.h"
#include "common/scene/data/scene_data.h"

namespace pt {

/// A value that may vary over a surface: color * texture(u, v).
struct ColorTexture {
  Color color = Color(1.0f);
  std::uint32_t texture = no_texture;

  bool is_constant() const { return texture == no_texture; }
};

inline Parameter parameter_of(const ColorTexture& value) { return {value.color, value.texture}; }

/// The material and all that it is made of, each once, although blends of blends may name one of
/// them 2^n times. The pointers are good until the scene gets another material.
inline std::vector<const MaterialDescription*> parts_of(const SceneData& scene,
                                                        const MaterialDescription& material) {
  std::vector<const MaterialDescription*> parts{&material};
  std::unordered_set<std::uint32_t> known;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i]->node == MaterialNode::none) continue;
    for (const std::uint32_t child : parts[i]->children) {
      if (known.insert(child).second) parts.push_back(&scene.materials[child]);
    }
  }
  return parts;
}

/// Whether shading asks where on the surface a point lies.
inline bool is_textured(const SceneData& scene, const MaterialDescription& material) {
  return std::ranges::any_of(parts_of(scene, material), [](const MaterialDescription* m) {
    return m->is_textured() || m->opacity.texture != no_texture ||
           (m->node == MaterialNode::none && uses_tangent(*m));
  });
}

/// Whether it asks in which directions texture coordinates grow.
inline bool needs_tangents(const SceneData& scene, const MaterialDescription& material) {
  return std::ranges::any_of(parts_of(scene, material), [](const MaterialDescription* m) {
    return m->node == MaterialNode::none ? uses_tangent(*m) : m->node >= MaterialNode::normal_map;
  });
}

/// A material under a map of heights or of normals, which gets its emission, opacity and media.
/// `add` gives the number of what is under the map.
template <class Add>
MaterialDescription under_map(MaterialNode node, const Parameter& map, MaterialDescription inside,
                              Add&& add) {
  MaterialDescription result = make_mapped(node, map, 0);
  std::swap(result.emission, inside.emission);
  std::swap(result.opacity, inside.opacity);
  std::swap(result.is_boundary, inside.is_boundary);
  std::swap(result.media, inside.media);
  result.children[0] = result.children[1] = add(inside);
  return result;
}

/// The index of refraction of what reflects so much along the normal; below 1.
inline float index_of_reflectance(float reflectance) {
  const float root = std::sqrt(reflectance);
  return (1.0f + root) / (1.0f - root);
}

/// The principled BSDF's gloss of a coat goes from a roughness, alpha, of 0.1 to 0.001.
inline float gloss_of_coat(float roughness) {
  return std::clamp((0.1f - roughness * roughness) / 0.099f, 0.0f, 1.0f);
}

inline float cosine_of_degrees(float degrees) { return std::cos(degrees * pi / 180.0f); }

/// A view as a file has written it.
struct LookAt {
  Vec3 origin, target;
  Vec3 up{0, 0, 0};  ///< 0: any
};

/// Gives a camera that maps have placed the origin, target and up direction that its file has
/// written, where they mean the same view.
inline void take_written_view(const LookAt& look, CameraParameters& camera) {
  const auto differ = [](const Vec3& a, const Vec3& b) {  // by more than rounding
    return !(glm::length(glm::normalize(a) - glm::normalize(b)) < 1e-5f);
  };
  const Vec3 forward = camera.look_at - camera.look_from;
  if (!(glm::length(look.origin - camera.look_from) <= 64.0f * half_ulp * max_abs(look.origin)) ||
      differ(forward, look.target - look.origin))
    return;
  camera.look_from = look.origin, camera.look_at = look.target;
  if (!differ(glm::cross(camera.up, forward), glm::cross(look.up, forward))) camera.up = look.up;
}

/// A camera that frames what there is, where that has a size.
inline void frame_finite_scene(SceneData& scene) {
  const Bounds bounds = scene_bounds(scene);
  if (std::isfinite(glm::length(bounds.max - bounds.min)) && !bounds.is_empty()) {
    scene.camera = frame_scene(scene);
  }
}

// How finely round shapes are tessellated.
inline constexpr int circle_segments = 256;    ///< a chord is within 7.5e-5 radii of its arc
inline constexpr int meridian_segments = 128;  ///< of a sphere, pole to pole

// Spectra to linear sRGB.

/// wavelength (nm, ascending) -> value
using Samples = std::vector<std::pair<double, double>>;

/// Emission is taken as it is; all else is seen under D65, so that 1 everywhere is white.
enum class Illuminant { equal_energy, d65 };

/// Linear sRGB of a sampled spectrum, with the CIE 1931 observer, as Mitsuba's RGB variants have
/// it.
Color spectrum_to_rgb(const Samples& samples, Illuminant illuminant);

/// Planck's law between two wavelengths in nm, W / (m^2 sr nm), as linear sRGB.
Color blackbody_to_rgb(double kelvin, double from_nm = 0.0, double to_nm = 1e9);

}  // namespace pt
