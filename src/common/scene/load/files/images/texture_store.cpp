#include "common/scene/load/files/images/texture_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <utility>

#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/texture/sample_texture.h"

namespace pt {
namespace {

constexpr std::size_t alignment = 16;  // of the first texel, bytes

bool same(const Texture& a, const Texture& b) {
  return a.kind == b.kind && a.format == b.format && a.wrap_u == b.wrap_u && a.wrap_v == b.wrap_v &&
         a.filter == b.filter && a.width == b.width && a.height == b.height &&
         a.offset == b.offset && std::equal(a.u_row, a.u_row + 3, b.u_row) &&
         std::equal(a.v_row, a.v_row + 3, b.v_row) && a.color0 == b.color0 &&
         a.color1 == b.color1 && std::equal(a.nested, a.nested + 2, b.nested);
}

/// Equal for textures that are the same; of most others it differs.
std::size_t hash_of(const Texture& texture) {
  std::size_t hash = texture.offset;
  const auto add = [&](float value) { hash = 31 * hash + std::hash<float>()(value); };
  for (int i = 0; i < 3; ++i) {
    add(texture.u_row[i]), add(texture.v_row[i]);
    add(texture.color0[i]), add(texture.color1[i]);
  }
  return 31 * hash + texture.nested[0] + 17 * std::size_t{texture.nested[1]};
}

/// The same file as linear8 and as srgb8, or grey, is two images.
std::string key_of(const std::string& name, const Texture& look,
                   const std::optional<Color>& weights) {
  const std::string grey =
      weights ? fmt::format("grey {} {} {} ", weights->x, weights->y, weights->z) : "";
  return grey + (look.format == TextureFormat::linear8 ? "linear " : "srgb ") + name;
}

TextureImage in_grey(TextureImage image, const std::optional<Color>& weights) {
  return weights ? grey_image(std::move(image), *weights) : image;
}

TextureFormat integers_of(const Texture& look) {
  return look.format == TextureFormat::linear8 ? TextureFormat::linear8 : TextureFormat::srgb8;
}

}  // namespace

std::uint32_t TextureStore::add_file(const std::filesystem::path& path, const Texture& look,
                                     const std::optional<Color>& weights) {
  std::error_code ignored;  // where there is no such file, reading it says so
  const std::filesystem::path file = std::filesystem::weakly_canonical(path, ignored);
  const std::string key = key_of(ignored ? path.string() : file.string(), look, weights);
  auto found = stored_.find(key);
  if (found == stored_.end()) {
    TextureImage image = in_grey(read_texture_image(path, integers_of(look)), weights);
    found = stored_.emplace(key, store(std::move(image))).first;
  }
  return add_stored(found->second, look);
}

std::uint32_t TextureStore::add_file_if_readable(
    const std::filesystem::path& path, const Texture& look, const std::optional<Color>& weights,
    const std::function<void(const std::string&)>& report) {
  try {
    return add_file(path, look, weights);
  } catch (const Error& error) {
    report(error.what());
    return no_texture;
  }
}

std::uint32_t TextureStore::add_memory(std::string_view bytes, const std::string& name,
                                       const Texture& look, const std::optional<Color>& weights) {
  const std::string key = key_of("memory " + name, look, weights);
  auto found = stored_.find(key);
  if (found == stored_.end()) {
    TextureImage image = in_grey(decode_texture_image(bytes, name, integers_of(look)), weights);
    found = stored_.emplace(key, store(std::move(image))).first;
  }
  return add_stored(found->second, look);
}

std::uint32_t TextureStore::add_decoded(const TextureImage& image, const std::string& name,
                                        const Texture& look, const std::optional<Color>& weights) {
  const std::string key = key_of("decoded " + name, look, weights);
  auto found = stored_.find(key);
  if (found == stored_.end()) {
    TextureImage copy = image;
    if (copy.format != TextureFormat::rgb32f) copy.format = integers_of(look);
    found = stored_.emplace(key, store(in_grey(std::move(copy), weights))).first;
  }
  return add_stored(found->second, look);
}

std::uint32_t TextureStore::add_image(TextureImage image, const Texture& look) {
  return add_stored(store(std::move(image)), look);
}

std::uint32_t TextureStore::add_plain(const Texture& texture) {
  const std::size_t hash = hash_of(texture);
  const auto [first, last] = by_hash_.equal_range(hash);
  const auto equal = std::find_if(
      first, last, [&](const auto& entry) { return same(textures_[entry.second], texture); });
  if (equal != last) return equal->second;
  textures_.push_back(texture);
  const auto number = static_cast<std::uint32_t>(textures_.size() - 1);
  by_hash_.emplace(hash, number);
  return number;
}

std::uint32_t TextureStore::add_alpha_of(std::uint32_t texture_index) {
  Texture alpha = textures_[texture_index];
  if (alpha.kind != TextureKind::image) return no_texture;
  alpha.color0 = Color(1.0f);
  if (alpha.format == TextureFormat::rgb32f) {
    const auto found = alphas_.find(alpha.offset);
    if (found == alphas_.end()) return no_texture;
    alpha.offset = found->second;
    return add_plain(alpha);
  }
  const std::size_t end = alpha.offset + std::size_t{4} * alpha.width * alpha.height;
  bool is_opaque = true;
  for (std::size_t i = alpha.offset + 3; i < end; i += 4) {
    is_opaque = is_opaque && texels_[i] == std::byte{255};
  }
  if (is_opaque) return no_texture;
  alpha.format = TextureFormat::alpha8;
  return add_plain(alpha);
}

bool TextureStore::is_normal_map(std::uint32_t texture_index) const {
  const Texture& texture = textures_[texture_index];
  double sum[3] = {};
  for (std::uint32_t y = 0; y < texture.height; ++y) {
    for (std::uint32_t x = 0; x < texture.width; ++x) {
      const Color c = load_texel(texture, texels_.data(), x, y);
      for (int i = 0; i < 3; ++i) sum[i] += c[i];
    }
  }
  const double red_green = 0.5 * (sum[0] + sum[1]);
  return sum[2] > 1.3 * red_green;
}

/// Returns where they begin. The first ones are not copied.
std::size_t TextureStore::append(std::vector<std::byte> bytes) {
  const std::size_t offset = (texels_.size() + alignment - 1) / alignment * alignment;
  if (texels_.empty()) {
    texels_ = std::move(bytes);
    return 0;
  }
  if (offset + bytes.size() > texels_.capacity()) {
    const std::size_t most = std::max(offset + bytes.size(), 2 * texels_.size());
    check_host_memory(most, "the pictures of the scene");
    texels_.reserve(most);
  }
  texels_.resize(offset);
  texels_.insert(texels_.end(), bytes.begin(), bytes.end());
  return offset;
}

TextureStore::Stored TextureStore::store(TextureImage image) {
  const Stored stored{image.format, image.width, image.height, append(std::move(image.texels))};
  if (image.alpha.empty()) return stored;
  std::vector<std::byte> grey(sizeof(Color) * image.alpha.size());
  for (std::size_t i = 0; i < image.alpha.size(); ++i) {
    const Color alpha(image.alpha[i]);
    std::memcpy(grey.data() + sizeof alpha * i, &alpha, sizeof alpha);
  }
  alphas_[stored.offset] = append(std::move(grey));
  return stored;
}

std::uint32_t TextureStore::add_stored(const Stored& stored, Texture look) {
  look.kind = TextureKind::image;
  look.format = stored.format;
  look.width = stored.width;
  look.height = stored.height;
  look.offset = stored.offset;
  return add_plain(look);
}

}  // namespace pt
