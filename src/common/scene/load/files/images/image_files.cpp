#include "common/scene/load/files/images/image_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <any>
#include <cstring>
#include <utility>

#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/image/codecs/image_codec.h"
#include "common/image/tone_mapping.h"
#include "common/scene/load/files/read_ahead.h"
#include "common/scene/load/files/whole_file.h"
#include "common/texture/sample_texture.h"

namespace pt {
namespace {

// Images whose components are numbers of their own.

/// Which component alone counts, with the weight 1; else -1.
int only_component(const Color& weights) {
  for (int i = 0; i < 3; ++i) {
    Color unit(0.0f);
    unit[i] = 1.0f;
    if (weights == unit) return i;
  }
  return -1;
}

bool is_grey(const TextureImage& image) {
  const std::size_t size = image.format == TextureFormat::rgb32f ? 4 : 1;  // of a component
  const std::size_t step = texel_bytes(image.format);
  for (std::size_t i = 0; i < image.texels.size(); i += step) {
    const std::byte* texel = image.texels.data() + i;
    if (std::memcmp(texel, texel + size, size) != 0) return false;
    if (std::memcmp(texel, texel + 2 * size, size) != 0) return false;
  }
  return true;
}

void copy_component(TextureImage& image, std::size_t component) {
  for (std::size_t i = 0; i < image.texels.size(); i += 4) {
    const std::byte value = image.texels[i + component];
    image.texels[i] = image.texels[i + 1] = image.texels[i + 2] = value;
  }
}

}  // namespace

TextureImage grey_image(TextureImage image, const Color& weights) {
  if (std::abs(weights.x + weights.y + weights.z - 1.0f) < 1e-5f && is_grey(image)) return image;
  const int component = only_component(weights);
  if (component >= 0 && image.format != TextureFormat::rgb32f) {
    copy_component(image, static_cast<std::size_t>(component));
    return image;
  }
  Texture look;
  look.format = image.format, look.width = image.width, look.height = image.height;
  TextureImage result = make_float_image(image.width, image.height, [&](auto x, auto y) {
    return Color(dot(weights, load_texel(look, image.texels.data(), x, y)));
  });
  result.alpha = std::move(image.alpha);
  return result;
}

namespace {

bool is_exr(std::string_view bytes) { return bytes.starts_with("\x76\x2f\x31\x01"); }
bool is_hdr(std::string_view bytes) { return bytes.starts_with("#?"); }
bool is_png(std::string_view bytes) { return bytes.starts_with("\x89PNG"); }
bool is_jpeg(std::string_view bytes) { return bytes.starts_with("\xff\xd8"); }
bool is_ppm(std::string_view bytes) { return bytes.starts_with("P6") || bytes.starts_with("P5"); }
bool is_pfm(std::string_view bytes) { return bytes.starts_with("PF") || bytes.starts_with("Pf"); }

/// Whether the format stores floats.
bool is_float(std::string_view bytes) { return is_exr(bytes) || is_hdr(bytes) || is_pfm(bytes); }

Image decode_floats(std::string_view bytes) {
  if (is_pfm(bytes)) return decode_pfm(bytes);
  ImageMetadata metadata;
  return is_exr(bytes) ? exr_codec.decode(bytes, &metadata) : decode_hdr(bytes);
}

IntegerImage decode_integers(std::string_view bytes) {
  if (is_png(bytes)) return decode_png_integers(bytes);
  if (is_ppm(bytes)) return decode_ppm_integers(bytes);
  return is_jpeg(bytes) ? decode_jpeg(bytes) : decode_bmp_or_tga(bytes);
}

/// Linear values of all integers from 0 to `white`.
std::vector<float> linear_values(std::size_t white, TextureFormat format) {
  std::vector<float> values(white + 1);
  for (std::size_t i = 0; i <= white; ++i) {
    const float share = static_cast<float>(i) / static_cast<float>(white);
    values[i] = format == TextureFormat::srgb8 ? srgb_curve.decode(share) : share;
  }
  return values;
}

/// The linear values of an image of integers. `alpha` (or null) gets theirs, or none if opaque.
template <class Value>
std::vector<float> linear_rgb(const std::vector<Value>& rgba, TextureFormat format,
                              std::vector<float>* alpha) {
  constexpr std::size_t white = sizeof(Value) == 1 ? 255 : 65535;
  const std::vector<float> linear = linear_values(white, format);
  std::vector<float> rgb(rgba.size() / 4 * 3);
  bool is_opaque = true;
  for (std::size_t i = 0; i < rgb.size(); ++i) {
    rgb[i] = linear[static_cast<std::size_t>(rgba[4 * (i / 3) + i % 3])];
  }
  if (alpha == nullptr) return rgb;
  for (std::size_t i = 3; i < rgba.size(); i += 4) {
    is_opaque = is_opaque && static_cast<std::size_t>(rgba[i]) == white;
  }
  if (is_opaque) return rgb;
  alpha->resize(rgba.size() / 4);
  for (std::size_t i = 0; i < alpha->size(); ++i) {
    (*alpha)[i] = static_cast<float>(rgba[4 * i + 3]) / static_cast<float>(white);
  }
  return rgb;
}

TextureImage texture_of(int width, int height, const std::vector<float>& rgb) {
  TextureImage texture{TextureFormat::rgb32f,
                       static_cast<std::uint32_t>(width),
                       static_cast<std::uint32_t>(height),
                       {}};
  const auto* first = reinterpret_cast<const std::byte*>(rgb.data());
  texture.texels.assign(first, first + sizeof(float) * rgb.size());
  return texture;
}

/// Floats take more memory than the values that they are decoded from.
void check_floats(double pixels, double bytes_per_pixel) {
  check_host_memory(static_cast<std::uint64_t>(pixels * bytes_per_pixel), "an image of 16 bits");
}

TextureImage decode_texture(std::string_view bytes, TextureFormat integers) {
  if (is_float(bytes)) {
    const Image image = decode_floats(bytes);
    return texture_of(image.width, image.height, image.rgb);
  }
  IntegerImage image = decode_integers(bytes);
  if (image.rgba16.empty()) {
    return {integers, static_cast<std::uint32_t>(image.width),
            static_cast<std::uint32_t>(image.height), std::move(image.rgba)};
  }
  check_floats(1.0 * image.width * image.height, 2 * sizeof(Color) + sizeof(float));
  std::vector<float> alpha;
  TextureImage texture =
      texture_of(image.width, image.height, linear_rgb(image.rgba16, integers, &alpha));
  texture.alpha = std::move(alpha);
  return texture;
}

Image decode_radiance(std::string_view bytes) {
  if (is_float(bytes)) return decode_floats(bytes);
  const IntegerImage encoded = decode_integers(bytes);
  check_floats(1.0 * encoded.width * encoded.height, sizeof(Color));
  constexpr TextureFormat srgb = TextureFormat::srgb8;
  return {encoded.width, encoded.height,
          encoded.rgba16.empty() ? linear_rgb(encoded.rgba, srgb, nullptr)
                                 : linear_rgb(encoded.rgba16, srgb, nullptr)};
}

}  // namespace

bool TextureImage::has_alpha() const {
  if (format == TextureFormat::rgb32f) return !alpha.empty();
  for (std::size_t i = 3; i < texels.size(); i += 4) {
    if (texels[i] != std::byte{255}) return true;
  }
  return false;
}

namespace {

/// A texture's; `name` is the file's, or stands for it.
std::string key_of(const std::string& name, TextureFormat integers) {
  return fmt::format("picture {} {}", static_cast<int>(integers), name);
}

/// Takes what was read ahead, or reads. Errors name what cannot be read.
template <class Read>
auto take(const std::string& key, const std::string& name, const Read& read) {
  return ReadAhead::take(key, [&] { return explaining("cannot read " + name, read); });
}

}  // namespace

TextureImage read_texture_image(const std::filesystem::path& path, TextureFormat integers) {
  return take(key_of(path.string(), integers), path.string(),
              [&] { return decode_texture(WholeFile(path).bytes(), integers); });
}

TextureImage decode_texture_image(std::string_view bytes, const std::string& name,
                                  TextureFormat integers) {
  return take(key_of(name, integers), name, [&] { return decode_texture(bytes, integers); });
}

Image read_radiance_image(const std::filesystem::path& path) {
  return take("radiance " + path.string(), path.string(),
              [&] { return decode_radiance(WholeFile(path).bytes()); });
}

namespace {

/// Loaders keep what they have read.
template <class Read>
void announce_once(const std::string& key, const Read& read) {
  if (ReadAhead::is_announced(key)) return;
  ReadAhead::announce(key, [read] { return std::any(read()); });
}

}  // namespace

void read_texture_ahead(const std::filesystem::path& path, TextureFormat integers) {
  announce_once(key_of(path.string(), integers),
                [=] { return read_texture_image(path, integers); });
}

void decode_texture_ahead(std::string_view bytes, const std::string& name, TextureFormat integers) {
  announce_once(key_of(name, integers),
                [=] { return decode_texture_image(bytes, name, integers); });
}

void read_radiance_ahead(const std::filesystem::path& path) {
  announce_once("radiance " + path.string(), [=] { return read_radiance_image(path); });
}

Image decode_radiance_image(std::string_view bytes, const std::string& name) {
  return explaining("cannot read " + name, [&] { return decode_radiance(bytes); });
}

}  // namespace pt
