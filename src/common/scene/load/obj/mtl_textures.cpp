#include "common/scene/load/obj/mtl_textures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "common/error/error.h"
#include "common/error/quoted.h"
#include "common/texture/sample_texture.h"

namespace pt::obj {
namespace {

const Color luminance(0.212671f, 0.715160f, 0.072169f);  // as grey_of has it

/// Of a scalar map. Alpha and the luminance of heights are taken elsewhere.
std::optional<Color> weights_of(char channel) {
  if (channel == 'r') return Color(1, 0, 0);
  if (channel == 'g') return Color(0, 1, 0);
  if (channel == 'b') return Color(0, 0, 1);
  return {};
}

TextureImage scaled(const TextureImage& image, float base, float gain, float most) {
  Texture look;
  look.format = image.format, look.width = image.width, look.height = image.height;
  TextureImage result{TextureFormat::rgb32f, image.width, image.height, {}};
  result.texels.resize(std::size_t{12} * image.width * image.height);
  std::byte* out = result.texels.data();
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x, out += 12) {
      const Color texel = load_texel(look, image.texels.data(), x, y);
      const Color value = glm::clamp(Color(base) + gain * texel, 0.0f, most);
      std::memcpy(out, &value, 12);
    }
  }
  return result;
}

}  // namespace

Texture MtlTextures::look_of(const MapUse& use, TextureFormat format) {
  const MtlMap& map = use.map;
  Texture look;
  look.format = format;
  look.u_row[0] = map.scale[0], look.u_row[2] = map.offset[0];
  look.v_row[1] = map.scale[1], look.v_row[2] = map.offset[1];
  if (map.clamps) look.wrap_u = look.wrap_v = TextureWrap::clamp;
  if (!map.blends[0] && !map.blends[1]) look.filter = TextureFilter::nearest;
  if (map.blends[0] != map.blends[1]) {
    warnings_.add("one blend", fmt::format("{}: {}: -blendu and -blendv differ: both are on",
                                           use.place, use.key));
  }
  return look;
}

template <class Read>
std::uint32_t MtlTextures::read_or_warn(const MapUse& use, const Read& read) {
  const std::filesystem::path path = path_of(use.map);
  std::string reason = path.empty() ? "no such file" : "";
  if (const auto known = unreadable_.find(path); known != unreadable_.end()) reason = known->second;
  if (reason.empty()) {
    try {
      return read(path);
    } catch (const Error& error) {
      reason = unreadable_[path] = error.what();
    }
  }
  warnings_.add(std::string("picture of ") + use.key,
                fmt::format("{}: {} {}: {}: {}", use.place, use.key, pt::in_quotes(use.map.name),
                            reason, use.instead),
                use.map.name);
  return no_texture;
}

std::uint32_t MtlTextures::add(const MapUse& use, TextureFormat format, const Weights& weights) {
  return read_or_warn(use, [&](const std::filesystem::path& path) {
    return store_.add_file(path, look_of(use, format), weights);
  });
}

std::uint32_t MtlTextures::add_scaled_file(const MapUse& use, const std::filesystem::path& path,
                                           const Texture& look, const Weights& weights,
                                           float most) {
  const MtlMap& map = use.map;
  const Color w = weights.value_or(Color(0.0f));
  const std::string key = fmt::format("{} {} {} {} {} {} {} {} {} {} {} {} {} {} {}", path.string(),
                                      static_cast<int>(look.format), map.base, map.gain, most, w.x,
                                      w.y, w.z, map.offset[0], map.offset[1], map.scale[0],
                                      map.scale[1], map.clamps, map.blends[0], map.blends[1]);
  const auto known = scaled_.find(key);
  if (known != scaled_.end()) return known->second;
  TextureImage image = read_texture_image(path, look.format);
  if (weights) image = grey_image(std::move(image), *weights);
  const std::uint32_t index = store_.add_image(scaled(image, map.base, map.gain, most), look);
  return scaled_.emplace(key, index).first->second;
}

std::uint32_t MtlTextures::add_scaled(const MapUse& use, TextureFormat format,
                                      const Weights& weights, float most) {
  if (use.map.base == 0.0f && use.map.gain == 1.0f) return add(use, format, weights);
  return read_or_warn(use, [&](const std::filesystem::path& path) {
    return add_scaled_file(use, path, look_of(use, format), weights, most);
  });
}

std::uint32_t MtlTextures::add_color(const MapUse& use, float most) {
  return add_scaled(use, TextureFormat::srgb8, {}, most);
}

std::uint32_t MtlTextures::add_number(const MapUse& use) {
  const Weights weights = weights_of(use.map.channel).value_or(luminance);
  return add_scaled(use, TextureFormat::linear8, weights, 1.0f);
}

std::uint32_t MtlTextures::add_plain(const MapUse& use) {
  return add(use, TextureFormat::linear8, weights_of(use.map.channel));
}

std::uint32_t MtlTextures::add_opacity(const MapUse& use, bool& is_opaque) {
  is_opaque = false;
  const std::uint32_t plain = add_plain(use);
  const bool asks_alpha = use.map.channel == 'm';
  if (plain == no_texture || (use.map.channel != '\0' && !asks_alpha)) return plain;
  const std::uint32_t alpha = store_.add_alpha_of(plain);
  is_opaque = asks_alpha && alpha == no_texture;
  return alpha != no_texture ? alpha : plain;
}

}  // namespace pt::obj
