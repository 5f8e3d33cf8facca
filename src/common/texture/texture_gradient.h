// The slope of a texture, for bump maps.
#pragma once

#include "common/texture/sample_texture.h"

namespace pt {

/// What a bump map takes for the height of a texel.
PT_HD float texel_height(const Texture& texture, const std::byte* texels, std::uint32_t x,
                         std::uint32_t y) {
  return grey_of(load_texel(texture, texels, x, y));
}

/// -1 where a mirrored coordinate runs backwards.
PT_HD float wrap_direction(float t, TextureWrap wrap) {
  return wrap == TextureWrap::mirror && t - 2.0f * floorf(0.5f * t) > 1.0f ? -1.0f : 1.0f;
}

/// The derivatives of the texture's luminance by the surface's u and v (v upwards): those of the
/// bilinear surface between four texels. A texture without slopes between texels has none.
PT_HD Vec2 texture_gradient(const Texture& texture, const std::byte* texels, const Vec2& uv) {
  if (texture.kind != TextureKind::image || texture.filter == TextureFilter::nearest) {
    return Vec2(0.0f);
  }
  const float *a = texture.u_row, *b = texture.v_row;
  const Vec2 at(fused_multiply_add(a[0], uv.x, fused_multiply_add(a[1], uv.y, a[2])),
                fused_multiply_add(b[0], uv.x, fused_multiply_add(b[1], uv.y, b[2])));
  const TexelPair x =
      find_texels(wrap_coordinate(at.x, texture.wrap_u), texture.width, texture.wrap_u);
  const TexelPair y =
      find_texels(1.0f - wrap_coordinate(at.y, texture.wrap_v), texture.height, texture.wrap_v);
  const float h00 = texel_height(texture, texels, x.first, y.first);
  const float h10 = texel_height(texture, texels, x.second, y.first);
  const float h01 = texel_height(texture, texels, x.first, y.second);
  const float h11 = texel_height(texture, texels, x.second, y.second);
  const auto between = [](float p, float q, float t) { return fused_multiply_add(t, q - p, p); };
  const float right = between(h10 - h00, h11 - h01, y.t) * static_cast<float>(texture.width) *
                      wrap_direction(at.x, texture.wrap_u);
  const float up = between(h00 - h01, h10 - h11, x.t) * static_cast<float>(texture.height) *
                   wrap_direction(at.y, texture.wrap_v);
  const Vec3 slope =
      weighted_sum({right, up, 0.0f}, Vec3(a[0], a[1], 0.0f), Vec3(b[0], b[1], 0.0f), Vec3(0.0f));
  return {texture.color0.x * slope.x, texture.color0.x * slope.y};
}

}  // namespace pt
