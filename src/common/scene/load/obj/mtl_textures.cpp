#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "common/error/error.h"
#include "common/scene/load/files/whole_file.h"
#include "common/scene/load/obj/mtl.h"
#include "common/texture/sample_texture.h"

namespace pt::obj {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t name_bytes_max = 4096;  // PATH_MAX of Linux
constexpr std::size_t last_parts_max = 8;

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return !path.empty() && fs::exists(path, ignored) && !fs::is_directory(path, ignored);
}

bool has_drive(std::string_view name) {
  const char letter = name.empty() ? '\0' : static_cast<char>(name[0] | 0x20);
  return name.size() > 1 && 'a' <= letter && letter <= 'z' && name[1] == ':';
}

/// The parts of a path of any system, without its root.
std::vector<std::string> parts_of(std::string_view name) {
  std::vector<std::string> parts;
  if (has_drive(name)) name.remove_prefix(2);
  while (!name.empty()) {
    const std::size_t end = std::min(name.find_first_of("/\\"), name.size());
    const std::string_view part = name.substr(0, end);
    if (!part.empty() && part != ".") parts.emplace_back(part);
    name.remove_prefix(std::min(end + 1, name.size()));
  }
  return parts;
}

/// The last `count` parts.
fs::path tail_of(const std::vector<std::string>& parts, std::size_t count) {
  fs::path path;
  for (std::size_t i = parts.size() - count; i < parts.size(); ++i) path /= parts[i];
  return path;
}

}  // namespace

fs::path NamedFiles::find(const std::vector<fs::path>& folders, std::string_view name) {
  if (name.empty() || name.size() > name_bytes_max) return {};
  const std::string key = folders.front().string() + '\n' + std::string(name);
  const auto known = found_.find(key);
  if (known != found_.end()) return known->second;
  return found_.emplace(key, search(folders, name)).first->second;
}

fs::path NamedFiles::search(const std::vector<fs::path>& folders, std::string_view name) {
  const auto warn = [&](const std::string& line) { warnings_.add("case", line, name); };
  const std::vector<std::string> parts = parts_of(name);
  const bool is_absolute = name[0] == '/' || name[0] == '\\' || has_drive(name);
  for (const fs::path& folder : folders) {  // a name on Linux may have \ or : in it
    if (is_file(folder / name)) return folder / name;
    if (is_absolute) continue;
    const fs::path path = find_file(folder, tail_of(parts, parts.size()), warn);
    if (is_file(path)) return path;
  }
  if (name[0] == '/') {
    const fs::path path = find_file({}, name, warn);
    if (is_file(path)) return path;
  }
  const std::size_t most = is_absolute ? parts.size() : parts.size() - std::min(parts.size(), 1ul);
  for (std::size_t count = std::min(most, last_parts_max); count > 0; --count) {
    const auto first = parts.end() - static_cast<std::ptrdiff_t>(count);
    if (std::find(first, parts.end(), "..") != parts.end()) continue;  // may lead above the folder
    for (const fs::path& folder : folders) {
      const fs::path path = find_file(folder, tail_of(parts, count), {});
      if (!is_file(path)) continue;
      warnings_.add("last parts",
                    fmt::format("{} does not exist: {} is used", in_quotes(name), path.string()),
                    name);
      return path;
    }
  }
  return {};
}

namespace {

const Color luminance(0.212671f, 0.715160f, 0.072169f);  // as grey_of has it

/// Weights of the channels in a scalar map. Alpha and the luminance of heights are taken elsewhere.
std::optional<Color> weights_of(char channel) {
  if (channel == 'r') return Color(1, 0, 0);
  if (channel == 'g') return Color(0, 1, 0);
  if (channel == 'b') return Color(0, 0, 1);
  return {};
}

TextureImage scaled(const TextureImage& image, float base, float gain, float most) {
  Texture look;
  look.format = image.format, look.width = image.width, look.height = image.height;
  return make_float_image(image.width, image.height, [&](auto x, auto y) {
    const Color texel = load_texel(look, image.texels.data(), x, y);
    return glm::clamp(Color(base) + gain * texel, 0.0f, most);
  });
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

void MtlTextures::read_ahead(const MtlMaterial& m) const {
  const auto read = [&](const MtlMap& map, TextureFormat format) {
    if (map.name.empty() || map.name.size() > name_bytes_max) return;
    for (const fs::path& folder : folders_) {
      if (is_file(folder / map.name)) return read_texture_ahead(folder / map.name, format);
    }
  };
  for (const MtlMap* map : {&m.map_Kd, &m.map_Ks, &m.map_Ke}) read(*map, TextureFormat::srgb8);
  for (const MtlMap* map : {&m.map_d, &m.map_Pr, &m.map_Pm, &m.bump, &m.norm})
    read(*map, TextureFormat::linear8);
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
