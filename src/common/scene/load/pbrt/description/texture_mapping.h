// How the pictures of a texture lie on surfaces: by a surface's own coordinates or by its points.
#pragma once

#include <vector>

#include "common/math/transform.h"
#include "common/scene/load/pbrt/syntax/parameters.h"

namespace pt::pbrt {

enum class MappingKind { uv, planar, spherical, cylindrical };

struct TextureMapping {
  MappingKind kind = MappingKind::uv;
  Affine to_texture;                      ///< of points of the world; not of uv
  Vec3 u_axis{1, 0, 0}, v_axis{0, 1, 0};  ///< planar
  Vec2 shift{0.0f};                       ///< planar

  bool is_uv() const { return kind == MappingKind::uv; }
  bool operator==(const TextureMapping& other) const;

  /// Of a point of the world, as pbrt has it.
  Vec2 at(const Vec3& point) const;
};

/// The mapping that all have, or uv with a warning; uv of none. Textures are looked up by the
/// coordinates of their surface, of which there are only one.
TextureMapping common_mapping(const std::vector<TextureMapping>& mappings, const Place& place,
                              Reporter& reporter);

}  // namespace pt::pbrt
