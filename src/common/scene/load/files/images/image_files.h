// Images in files, as texels and as radiance: JPEG, PNG, BMP, TGA, PPM, PGM, PFM, Radiance (.hdr)
// and OpenEXR. The content decides the format, not the file's name.
//
// Errors are Error, one line with the file's name, for one that is missing, of another format,
// truncated, corrupted or larger than 65535 pixels a side.
#pragma once

#include <cstddef>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/image/image.h"
#include "common/texture/texture.h"

namespace pt {

/// An image in the layout that Texture describes.
struct TextureImage {
  TextureFormat format = TextureFormat::srgb8;
  std::uint32_t width = 0, height = 0;
  std::vector<std::byte> texels;  ///< row 0 is the image's head
  std::vector<float> alpha = {};  ///< of an rgb32f: one value a texel, or empty: opaque

  bool has_alpha() const;
};

/// Integers become `integers`, srgb8 or linear8, whose alpha is opaque where the file has none. But
/// those of 16 bits become rgb32f, decoded as `integers` says, unless 8 bits hold all of their
/// values; floats (.hdr, .exr, .pfm) become rgb32f without alpha. Grey becomes RGB.
TextureImage read_texture_image(const std::filesystem::path& path,
                                TextureFormat integers = TextureFormat::srgb8);

/// The same of a file's content in memory; `name` stands for it in errors.
TextureImage decode_texture_image(std::string_view bytes, const std::string& name,
                                  TextureFormat integers = TextureFormat::srgb8);

/// A picture of floats; `color_at(x, y)` gives its texels, row by row.
template <class ColorAt>
TextureImage make_float_image(std::uint32_t width, std::uint32_t height, ColorAt&& color_at) {
  TextureImage image{TextureFormat::rgb32f, width, height, {}};
  image.texels.resize(sizeof(Color) * width * height);
  std::byte* next = image.texels.data();
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x, next += sizeof(Color)) {
      const Color color = color_at(x, y);
      std::memcpy(next, &color, sizeof color);
    }
  }
  return image;
}

/// The image with the weighted sum of its linear R, G and B in all of them; itself where that is
/// the same. One component alone keeps its 8 bits. Alpha stays.
TextureImage grey_image(TextureImage image, const Color& weights);

/// Linear RGB of any of the formats, integers decoded with the sRGB curve: for environment maps.
Image read_radiance_image(const std::filesystem::path& path);
Image decode_radiance_image(std::string_view bytes, const std::string& name);

// Each announces one call of the function that it is named after (read_ahead.h), once.

void read_texture_ahead(const std::filesystem::path& path, TextureFormat integers);
void decode_texture_ahead(std::string_view bytes, const std::string& name, TextureFormat integers);
void read_radiance_ahead(const std::filesystem::path& path);

}  // namespace pt
