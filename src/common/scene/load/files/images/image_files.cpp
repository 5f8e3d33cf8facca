#include "common/scene/load/files/images/image_files.h"

#include <array>
#include <cstring>

#include "common/error/error_context.h"
#include "common/image/codecs/image_codec.h"
#include "common/image/codecs/rgba8.h"
#include "common/image/codecs/tone_mapping.h"
#include "common/scene/load/files/mapped_file.h"

namespace pt {
namespace {

bool is_exr(std::string_view bytes) { return bytes.starts_with("\x76\x2f\x31\x01"); }
bool is_hdr(std::string_view bytes) { return bytes.starts_with("#?"); }
bool is_png(std::string_view bytes) { return bytes.starts_with("\x89PNG"); }
bool is_jpeg(std::string_view bytes) { return bytes.starts_with("\xff\xd8"); }
bool is_ppm(std::string_view bytes) { return bytes.starts_with("P6") || bytes.starts_with("P5"); }
bool is_pfm(std::string_view bytes) { return bytes.starts_with("PF") || bytes.starts_with("Pf"); }

/// Of formats that store floats.
bool is_float(std::string_view bytes) { return is_exr(bytes) || is_hdr(bytes) || is_pfm(bytes); }

Image decode_floats(std::string_view bytes) {
  if (is_pfm(bytes)) return decode_pfm(bytes);
  ImageMetadata metadata;
  return is_exr(bytes) ? exr_codec.decode(bytes, &metadata) : decode_hdr(bytes);
}

Rgba8Image decode_integers(std::string_view bytes) {
  if (is_png(bytes)) return decode_png_rgba8(bytes);
  if (is_ppm(bytes)) return decode_ppm_rgba8(bytes);
  return is_jpeg(bytes) ? decode_jpeg(bytes) : decode_bmp_or_tga(bytes);
}

TextureImage decode_texture(std::string_view bytes, TextureFormat integers) {
  if (!is_float(bytes)) {
    Rgba8Image image = decode_integers(bytes);
    return {integers, static_cast<std::uint32_t>(image.width),
            static_cast<std::uint32_t>(image.height), std::move(image.rgba)};
  }
  const Image image = decode_floats(bytes);
  TextureImage texture{TextureFormat::rgb32f,
                       static_cast<std::uint32_t>(image.width),
                       static_cast<std::uint32_t>(image.height),
                       {}};
  texture.texels.resize(sizeof(float) * image.rgb.size());
  std::memcpy(texture.texels.data(), image.rgb.data(), texture.texels.size());
  return texture;
}

Image decode_radiance(std::string_view bytes) {
  if (is_float(bytes)) return decode_floats(bytes);
  const Rgba8Image encoded = decode_integers(bytes);
  std::array<float, 256> linear;
  for (int i = 0; i < 256; ++i) linear[i] = srgb_curve.decode(static_cast<float>(i) / 255.0f);
  Image image{encoded.width, encoded.height, {}};
  image.rgb.resize(std::size_t{3} * image.width * image.height);
  for (std::size_t i = 0; i < image.rgb.size(); ++i) {
    image.rgb[i] = linear[std::to_integer<std::size_t>(encoded.rgba[4 * (i / 3) + i % 3])];
  }
  return image;
}

}  // namespace

TextureImage read_texture_image(const std::filesystem::path& path, TextureFormat integers) {
  return explaining("cannot read " + path.string(),
                    [&] { return decode_texture(MappedFile(path).bytes(), integers); });
}

TextureImage decode_texture_image(std::string_view bytes, const std::string& name,
                                  TextureFormat integers) {
  return explaining("cannot read " + name, [&] { return decode_texture(bytes, integers); });
}

Image read_radiance_image(const std::filesystem::path& path) {
  return explaining("cannot read " + path.string(),
                    [&] { return decode_radiance(MappedFile(path).bytes()); });
}

Image decode_radiance_image(std::string_view bytes, const std::string& name) {
  return explaining("cannot read " + name, [&] { return decode_radiance(bytes); });
}

}  // namespace pt
