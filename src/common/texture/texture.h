// Textures: colours over (u, v).
#pragma once

#include "common/math/vec.h"

namespace pt {

inline constexpr std::uint32_t no_texture = 0xffffffffu;

enum class TextureKind : std::uint8_t { image, checkerboard };
enum class TextureFormat : std::uint8_t {
  srgb8,    ///< 4 bytes a texel, R G B A; R, G and B in the sRGB curve
  linear8,  ///< 4 bytes a texel, linear
  alpha8,   ///< 4 bytes a texel: of these A, for all components
  rgb32f    ///< three floats a texel, linear
};
constexpr std::size_t texel_bytes(TextureFormat format) {
  return format == TextureFormat::rgb32f ? 12 : 4;
}

enum class TextureWrap : std::uint8_t { repeat, clamp, mirror };
enum class TextureFilter : std::uint8_t { bilinear, nearest };

/// A plain record. Texels lie row by row from the image's head, v = 1, to its foot, v = 0.
struct alignas(16) Texture {
  TextureKind kind = TextureKind::image;
  TextureFormat format = TextureFormat::srgb8;
  TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
  TextureFilter filter = TextureFilter::bilinear;
  std::uint32_t width = 0, height = 0;  ///< texels
  std::uint64_t offset = 0;             ///< of the first texel in the scene's texel memory, bytes
  // (u, v) of the surface to (u, v) of the texture
  float u_row[3] = {1, 0, 0};
  float v_row[3] = {0, 1, 0};
  Color color0 = Color(1.0f);  ///< image: factor; checkerboard: of the square at (0, 0)
  Color color1 = Color(0.0f);  ///< checkerboard: the others
  /// Checkerboard: the indices of earlier textures that the colours multiply.
  std::uint32_t nested[2] = {no_texture, no_texture};
  std::uint32_t index = 0;  ///< its own, in a prepared scene
};

}  // namespace pt
