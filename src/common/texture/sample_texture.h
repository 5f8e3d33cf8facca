// Looking up a texture.
//
// Texels are decoded before they are filtered. Every operation says whether it is fused, so that
// two kernels cannot round differently (see platform.h).
#pragma once

#include <cstddef>

#include "common/texture/texture.h"

namespace pt {

/// Linear value of the sRGB curve (IEC 61966-2-1) at byte / 255, 0 and 1 exactly. Above the curve's
/// linear part a polynomial, fitted to the 245 values that a byte can have: off by less than 1e-5
/// and less than 1/800 of the step to the next byte. A table would be exact, but its 12 gathers for
/// a bilinear lookup cost a GPU's L1 cache, which traversal keeps busy, more than 84 fused
/// operations cost its arithmetic.
PT_HD float srgb_to_linear(std::uint32_t byte) {
  const float c = static_cast<float>(byte) * (1.0f / 255.0f);
  if (byte <= 10) return c * (1.0f / 12.92f);
  float sum = 0.09612036496400833f;
  sum = fused_multiply_add(sum, c, -0.39592963457107544f);
  sum = fused_multiply_add(sum, c, 0.7066987752914429f);
  sum = fused_multiply_add(sum, c, -0.774587869644165f);
  sum = fused_multiply_add(sum, c, 0.8445791602134705f);
  sum = fused_multiply_add(sum, c, 0.48702272772789f);
  sum = fused_multiply_add(sum, c, 0.035241276025772095f);
  return fused_multiply_add(sum, c, 0.0008551938226446509f);
}

/// The scalar value of a texture: its luminance, as in Mitsuba.
PT_HD float grey_of(const Color& c) { return dot(c, Vec3(0.212671f, 0.715160f, 0.072169f)); }

/// A coordinate brought into [0, 1]; one that is not a number becomes 0.
PT_HD float wrap_coordinate(float t, TextureWrap wrap) {
  if (wrap == TextureWrap::repeat) t -= floorf(t);
  if (wrap == TextureWrap::mirror) {
    t = t - 2.0f * floorf(0.5f * t);  // exact products
    if (t > 1.0f) t = 2.0f - t;
  }
  return fminf(fmaxf(t, 0.0f), 1.0f);
}

/// The linear colour of a texel; x < width, y < height, row 0 the image's head.
PT_HD Color load_texel(const Texture& texture, const std::byte* texels, std::uint32_t x,
                       std::uint32_t y) {
  const std::size_t texel = static_cast<std::size_t>(y) * texture.width + x;
  if (texture.format == TextureFormat::rgb32f) {
    const auto* rgb = reinterpret_cast<const float*>(texels + texture.offset) + 3 * texel;
    return {rgb[0], rgb[1], rgb[2]};
  }
  const std::uint32_t rgba = reinterpret_cast<const std::uint32_t*>(texels + texture.offset)[texel];
  const std::uint32_t r = rgba & 0xffu, g = (rgba >> 8) & 0xffu, b = (rgba >> 16) & 0xffu;
  if (texture.format == TextureFormat::srgb8) {
    return {srgb_to_linear(r), srgb_to_linear(g), srgb_to_linear(b)};
  }
  constexpr float scale = 1.0f / 255.0f;
  if (texture.format == TextureFormat::alpha8) {
    return Color(static_cast<float>(rgba >> 24) * scale);
  }
  return {static_cast<float>(r) * scale, static_cast<float>(g) * scale,
          static_cast<float>(b) * scale};
}

/// The two texels next to a coordinate in [0, 1] of an axis with `size` texels, and how far it lies
/// from the first to the second. Texel i has its centre at (i + 1/2) / size.
struct TexelPair {
  std::uint32_t first, second;
  float t;
};

PT_HD TexelPair find_texels(float coordinate, std::uint32_t size, TextureWrap wrap) {
  const float x = fused_multiply_add(coordinate, static_cast<float>(size), -0.5f);
  const float below = floorf(x);
  const int last = static_cast<int>(size) - 1;
  int first = static_cast<int>(below), second = first + 1;  // -1 .. last, 0 .. last + 1
  const bool repeats = wrap == TextureWrap::repeat;         // a mirrored edge adjoins itself
  if (first < 0) first = repeats ? last : 0;
  if (second > last) second = repeats ? 0 : last;
  if (first > last) first = last;
  return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(second), x - below};
}

PT_HD std::uint32_t nearest_texel(float coordinate, std::uint32_t size) {
  const auto i = static_cast<std::uint32_t>(coordinate * static_cast<float>(size));
  return i < size ? i : size - 1;
}

/// An image at texture coordinates; v = 1 is its head.
PT_HD Color sample_image(const Texture& texture, const std::byte* texels, const Vec2& uv) {
  const float u = wrap_coordinate(uv.x, texture.wrap_u);
  const float down = 1.0f - wrap_coordinate(uv.y, texture.wrap_v);
  if (texture.filter == TextureFilter::nearest) {
    return load_texel(texture, texels, nearest_texel(u, texture.width),
                      nearest_texel(down, texture.height));
  }
  const TexelPair x = find_texels(u, texture.width, texture.wrap_u);
  const TexelPair y = find_texels(down, texture.height, texture.wrap_v);
  const Color head = interpolate(load_texel(texture, texels, x.first, y.first),
                                 load_texel(texture, texels, x.second, y.first), x.t);
  const Color foot = interpolate(load_texel(texture, texels, x.first, y.second),
                                 load_texel(texture, texels, x.second, y.second), x.t);
  return interpolate(head, foot, y.t);
}

/// Squares of half a unit, as Mitsuba's texture `checkerboard` has them: whether this is one of the
/// first colour.
PT_HD bool is_first_square(const Vec2& uv) {
  const bool right = uv.x - floorf(uv.x) > 0.5f, upper = uv.y - floorf(uv.y) > 0.5f;
  return right == upper;
}
PT_HD Color sample_checkerboard(const Texture& texture, const Vec2& uv) {
  return is_first_square(uv) ? texture.color0 : texture.color1;
}

/// The coordinates of a surface to the texture's.
PT_HD Vec2 map_coordinates(const Texture& texture, const Vec2& uv) {
  const float *a = texture.u_row, *b = texture.v_row;
  return {fused_multiply_add(a[0], uv.x, fused_multiply_add(a[1], uv.y, a[2])),
          fused_multiply_add(b[0], uv.x, fused_multiply_add(b[1], uv.y, b[2]))};
}

/// The linear colour, at the coordinates of a surface, of a texture that names no others. `texels`
/// is the scene's texel memory, 16-byte aligned.
PT_HD Color sample_texture(const Texture& texture, const std::byte* texels, const Vec2& uv) {
  const Vec2 mapped = map_coordinates(texture, uv);
  if (texture.kind == TextureKind::checkerboard) return sample_checkerboard(texture, mapped);
  return sample_image(texture, texels, mapped) * texture.color0;
}

/// The same of any of the scene's textures, by its index. What a checkerboard names has its own
/// map of the surface's coordinates, as in Mitsuba.
PT_HD Color sample_texture(const Texture* textures, std::uint32_t texture_index,
                           const std::byte* texels, const Vec2& uv) {
  const Texture* texture = &textures[texture_index];
  Color factor(1.0f);
  while (texture->kind == TextureKind::checkerboard) {
    const bool first = is_first_square(map_coordinates(*texture, uv));
    const std::uint32_t nested = texture->nested[first ? 0 : 1];
    if (nested == no_texture) break;
    factor *= first ? texture->color0 : texture->color1;
    texture = &textures[nested];
  }
  return factor * sample_texture(*texture, texels, uv);
}

/// The height of a texel in a bump map.
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
  const Vec2 at = map_coordinates(texture, uv);
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
