#include "common/scene/load/pbrt/description/texture_mapping.h"

#include <algorithm>
#include <cmath>

namespace pt::pbrt {

bool TextureMapping::operator==(const TextureMapping& other) const {
  return kind == other.kind && u_axis == other.u_axis && v_axis == other.v_axis &&
         shift == other.shift &&
         std::equal(to_texture.row, to_texture.row + 3, other.to_texture.row);
}

Vec2 TextureMapping::at(const Vec3& point) const {
  const Vec3 p = to_texture.point(point);
  if (kind == MappingKind::planar) {
    return shift + Vec2(glm::dot(p, u_axis), glm::dot(p, v_axis));
  }
  const float turn = std::atan2(p.y, p.x) * 0.5f * inverse_pi;
  if (kind == MappingKind::cylindrical) return {0.5f + turn, p.z};
  const float length = glm::length(p);
  const float cosine = length > 0.0f ? glm::clamp(p.z / length, -1.0f, 1.0f) : 1.0f;
  return {std::acos(cosine) * inverse_pi, turn < 0.0f ? turn + 1.0f : turn};
}

TextureMapping common_mapping(const std::vector<TextureMapping>& mappings, const Place& place,
                              Reporter& reporter) {
  if (mappings.empty()) return {};
  for (const TextureMapping& mapping : mappings) {
    if (mapping == mappings.front()) continue;
    reporter.warn_once("mappings", place,
                       "textures of different mappings on one surface are not supported: uv is "
                       "used for all");
    return {};
  }
  return mappings.front();
}

}  // namespace pt::pbrt
