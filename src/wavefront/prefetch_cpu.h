// Prefetches of what shading reads at random addresses, for paths that are shaded later. In three
// steps: each needs what the step before has prefetched.
#pragma once

#include "common/sampling/alias_table.h"
#include "common/scene/data/scene.h"
#include "common/texture/sample_texture.h"

namespace pt {

/// The cache lines of *p.
template <class T>
void prefetch(const T* p) {
  const char* const begin = reinterpret_cast<const char*>(p);
  constexpr std::size_t line_bytes = 64;
  for (std::size_t i = 0; i < sizeof(T); i += line_bytes) __builtin_prefetch(begin + i);
  __builtin_prefetch(begin + sizeof(T) - 1);
  // GCC takes functions that do nothing but prefetch for functions that do nothing (seen: 12.2),
  // and leaves out their calls. Not one that does this:
  asm volatile("" : : "r"(p));
}

/// The triangle that a ray has hit, or null.
inline const Triangle* triangle_of(const Scene& scene, const Hit& hit) {
  const std::uint32_t primitives = scene.primitives.count();
  if (hit.is_miss() || hit.primitive < primitives) return nullptr;
  return &scene.triangles.triangles[hit.primitive - primitives];
}

/// Whether these numbers sample the environment; nearly always right.
inline bool asks_environment(const Scene& scene, const Vec4& light) {
  return light.z < scene.light_selector.environment_probability;
}

/// The triangle, and the entry of the table by which the environment is sampled.
inline void prefetch_records(const Scene& scene, const Hit& hit, const Vec4& light) {
  if (const Triangle* const triangle = triangle_of(scene, hit)) prefetch(triangle);
  if (!asks_environment(scene, light)) return;
  const Environment& env = scene.environment;
  const float cells = static_cast<float>(env.width) * static_cast<float>(env.bands());
  prefetch(env.alias + static_cast<std::uint64_t>(light.x * cells));  // that or one beside it
}

/// What these say: the attributes of the triangle's corners, and texels of the environment.
inline void prefetch_attributes(const Scene& scene, const Hit& hit, const Vec4& light) {
  const Triangle* const triangle = triangle_of(scene, hit);
  if (triangle != nullptr && triangle->attributes != 0) prefetch(&scene.corners[triangle->id]);
  if (!asks_environment(scene, light)) return;
  const Environment& env = scene.environment;
  const AliasSample cell = sample_alias(env.alias, env.width * env.bands(), light.x, light.y);
  prefetch(&env.texels[cell.index]);
  if (env.height > 1) prefetch(&env.texels[cell.index + env.width]);
}

/// Approximately where a ray hits a triangle, as weights of v1 and v2.
inline Vec2 rough_barycentric(const Ray& ray, float t, const Triangle& triangle) {
  const Vec3 edge1 = triangle.v1 - triangle.v0, edge2 = triangle.v2 - triangle.v0;
  const Vec3 p = ray.origin + t * ray.direction - triangle.v0;
  const Vec3 normal = glm::cross(edge1, edge2);
  const float scale = 1.0f / dot(normal, normal);
  return {scale * dot(glm::cross(p, edge2), normal), scale * dot(glm::cross(edge1, p), normal)};
}

/// The texels, in both rows, of the image that colours the material there, in a scene without
/// instances.
inline void prefetch_texels(const Scene& scene, const Ray& ray, const Hit& hit) {
  const Triangle* const triangle = triangle_of(scene, hit);
  if (triangle == nullptr || (triangle->attributes & TriangleAttributes::uvs) == 0) return;
  const std::uint32_t texture_index = scene.parameters[triangle->material].texture;
  if (texture_index == no_texture) return;
  const Texture& texture = scene.textures[texture_index];
  if (texture.kind != TextureKind::image) return;
  const Vec2 b = rough_barycentric(ray, hit.t, *triangle);
  const Vec2 uv = scene.corners[triangle->id].uv_at(Vec3(1.0f - b.x - b.y, b.x, b.y));
  const Vec2 mapped = map_coordinates(texture, uv);
  const TexelPair x =
      find_texels(wrap_coordinate(mapped.x, texture.wrap_u), texture.width, texture.wrap_u);
  const TexelPair y =
      find_texels(1.0f - wrap_coordinate(mapped.y, texture.wrap_v), texture.height, texture.wrap_v);
  const std::size_t bytes = texel_bytes(texture.format);
  const std::byte* const texels = scene.texels + texture.offset;
  for (const std::uint32_t row : {y.first, y.second}) {
    prefetch(texels + bytes * (std::size_t{row} * texture.width + x.first));
  }
}

}  // namespace pt
