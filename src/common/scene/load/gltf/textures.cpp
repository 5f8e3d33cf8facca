#include <algorithm>
#include <cmath>
#include <cstring>

#include "common/scene/load/gltf/document.h"
#include "common/scene/load/gltf/materials.h"
#include "common/texture/sample_texture.h"

namespace pt::gltf {
namespace {

TextureWrap to_wrap(File& file, int wrap, const std::string& place) {
  switch (wrap) {
    case TINYGLTF_TEXTURE_WRAP_REPEAT:
      return TextureWrap::repeat;
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
      return TextureWrap::clamp;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
      return TextureWrap::mirror;
    default:
      file.report(place, "{}: expected 10497, 33071 or 33648: repeat is used", wrap);
      return TextureWrap::repeat;
  }
}

/// Path tracing averages over a pixel, so that mipmaps, minFilter's subject, have no part.
void apply_sampler(File& file, const tinygltf::Texture& texture, const std::string& place,
                   Texture& look) {
  if (texture.sampler < 0 || !file.has(file.model.samplers, texture.sampler, "samplers",
                                       place + ".sampler", "repeat is used")) {
    return;
  }
  const auto& sampler = file.model.samplers[static_cast<std::size_t>(texture.sampler)];
  const std::string sampler_place = fmt::format("samplers[{}]", texture.sampler);
  look.wrap_u = to_wrap(file, sampler.wrapS, sampler_place + ".wrapS");
  look.wrap_v = to_wrap(file, sampler.wrapT, sampler_place + ".wrapT");
  if (sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST) look.filter = TextureFilter::nearest;
}

/// KHR_texture_transform: translation * rotation * scale of (u, v) with v down from the image's
/// head; a positive rotation turns the coordinates counterclockwise as one sees the image. Ours
/// goes up: v' = 1 - v on both sides.
void apply_transform(const tinygltf::Value& transform, Texture& look) {
  const Vec2 offset = vector_or(transform, "offset", Vec2(0.0f));
  const Vec2 scale = vector_or(transform, "scale", Vec2(1.0f));
  const float rotation = number_or(transform, "rotation", 0.0f);
  const float c = std::cos(rotation), s = std::sin(rotation);
  const float uu = c * scale.x, uv = s * scale.y, vu = -s * scale.x, vv = c * scale.y;
  look.u_row[0] = uu, look.u_row[1] = -uv, look.u_row[2] = uv + offset.x;
  look.v_row[0] = -vu, look.v_row[1] = vv, look.v_row[2] = 1.0f - vv - offset.y;
}

/// First the map, then what the texture does with the coordinates.
void apply_uv_map(const UvMap& map, Texture& look) {
  for (float* row : {look.u_row, look.v_row}) {
    const float a = row[0], b = row[1];
    for (int i = 0; i < 3; ++i)
      row[i] = a * map.u_row[i] + b * map.v_row[i] + (i == 2 ? row[2] : 0);
  }
}

/// KHR_texture_transform may name another set of coordinates.
TextureUse with_transform(TextureUse use, const tinygltf::Value* transform) {
  if (!transform) return use;
  use.transform = *transform;
  use.tex_coord = integer_or(*transform, "texCoord", use.tex_coord);
  return use;
}

}  // namespace

template <class Info>
TextureUse texture_use(const Info& info) {
  return with_transform({info.index, info.texCoord, {}},
                        find_extension(info.extensions, "KHR_texture_transform"));
}
template TextureUse texture_use(const tinygltf::TextureInfo&);
template TextureUse texture_use(const tinygltf::NormalTextureInfo&);

template <>
TextureUse texture_use(const tinygltf::Value& info) {
  const tinygltf::Value& transform = member(member(info, "extensions"), "KHR_texture_transform");
  return with_transform({integer_or(info, "index", -1), integer_or(info, "texCoord", 0), {}},
                        transform.IsObject() ? &transform : nullptr);
}

const tinygltf::Texture& Textures::texture(const TextureUse& use, const std::string& place) const {
  return file_.at(file_.model.textures, use.texture, "textures", place + ".index");
}

const tinygltf::Image& Textures::image_at(int source, const TextureUse& use) const {
  return file_.at(file_.model.images, source, "images",
                  fmt::format("textures[{}].source", use.texture));
}

Textures::Encoded Textures::encoded_image(const TextureUse& use, const std::string& place) const {
  const int source = texture(use, place).source;
  if (source < 0) {
    file_.fail(fmt::format("textures[{}].source", use.texture),
               "no image in a format that is supported");
  }
  const tinygltf::Image& image = image_at(source, use);
  const std::string image_place = fmt::format("images[{}]", source);
  const auto text = [](const unsigned char* data, std::size_t size) {
    return std::string_view(reinterpret_cast<const char*>(data), size);
  };
  // The store knows images by their names, so the name carries the image's number.
  const std::string name =
      file_.describe(image_place + (image.uri.empty() ? "" : " = " + image.uri));
  if (image.bufferView >= 0) {  // within its buffer: check_json
    const auto& view = file_.at(file_.model.bufferViews, image.bufferView, "bufferViews",
                                image_place + ".bufferView");
    const auto& buffer = file_.at(file_.model.buffers, view.buffer, "buffers", image_place);
    return {text(buffer.data.data() + view.byteOffset, view.byteLength), name};
  }
  if (image.image.empty()) {
    file_.fail(image_place, "cannot read '{:.200}'", image.uri);
  }
  return {text(image.image.data(), image.image.size()), name};
}

TextureImage Textures::integers(const TextureUse& use, const std::string& place) const {
  const Encoded encoded = encoded_image(use, place);
  TextureImage image = decode_texture_image(encoded.bytes, encoded.name, TextureFormat::linear8);
  return image;
}

Texture Textures::look_of(const TextureUse& use, TextureFormat format) {
  const std::string place = fmt::format("textures[{}]", use.texture);
  Texture look;
  look.format = format;
  apply_sampler(file_, texture(use, place), place, look);
  if (use.transform.IsObject()) apply_transform(use.transform, look);
  if (const auto map = uv_maps_.find(use.tex_coord); map != uv_maps_.end()) {
    apply_uv_map(map->second, look);
  }
  return look;
}

std::uint32_t Textures::decode(const TextureUse& use, const std::string& place,
                               TextureFormat format, const std::optional<Color>& weights) {
  const Encoded image = encoded_image(use, place);
  return store_.add_memory(image.bytes, image.name, look_of(use, format), weights);
}

std::optional<Textures::Veil> Textures::add_veil(const TextureUse& use, const std::string& place,
                                                 float factor, bool coloured) {
  const Encoded encoded = encoded_image(use, place);
  TextureImage image = decode_texture_image(encoded.bytes, encoded.name, TextureFormat::srgb8);
  if (image.format != TextureFormat::srgb8) return std::nullopt;
  TextureImage emission{TextureFormat::rgb32f, image.width, image.height, {}};
  emission.texels.resize(3 * image.texels.size());
  Texture size = look_of(use, TextureFormat::srgb8);
  size.width = image.width, size.height = image.height;
  for (std::size_t i = 0; i < image.texels.size() / 4; ++i) {
    const auto x = static_cast<std::uint32_t>(i % image.width);
    const auto y = static_cast<std::uint32_t>(i / image.width);
    std::byte* texel = &image.texels[4 * i];
    const float alpha = factor * static_cast<float>(std::to_integer<int>(texel[3])) / 255.0f;
    const float through = std::sqrt(1.0f - std::min(alpha, 1.0f));
    const Color color = coloured ? load_texel(size, image.texels.data(), x, y) : Color(1.0f);
    const Color shown = (1.0f + through) * color;
    std::memcpy(&emission.texels[12 * i], &shown, sizeof shown);
    const auto opacity = static_cast<std::byte>(std::lround(255.0f * (1.0f - through)));
    texel[0] = texel[1] = texel[2] = opacity;
  }
  image.format = TextureFormat::linear8;
  return Veil{store_.add_image(image, look_of(use, TextureFormat::linear8)),
              store_.add_image(emission, look_of(use, TextureFormat::rgb32f))};
}

std::uint32_t Textures::add(const TextureUse& use, const std::string& place, TextureFormat format,
                            const std::optional<Color>& weights, const char* instead) {
  try {
    return decode(use, place, format, weights);
  } catch (const Error& error) {
    file_.report(place, "{}: {}", error.what(), instead);
    return no_texture;
  }
}

void Textures::read_ahead(const TextureUse& use, TextureFormat format) const {
  if (!use) return;
  try {
    const Encoded image = encoded_image(use, "");
    decode_texture_ahead(image.bytes, image.name, format);
  } catch (const Error&) {  // said where the texture is added
  }
}

Color Textures::mean(const TextureUse& use, const std::string& place) {
  TextureImage image;
  try {
    image = integers(use, place);
  } catch (const Error& error) {
    file_.report(place, "{}: the factor alone is used", error.what());
    return Color(1.0f);
  }
  double sum[3] = {}, white = 255.0;
  if (image.format == TextureFormat::rgb32f) {  // of 16 bits
    white = 1.0;
    for (std::size_t i = 0; i < image.texels.size(); i += sizeof(Color)) {
      Color texel;
      std::memcpy(&texel, image.texels.data() + i, sizeof texel);
      for (int j = 0; j < 3; ++j) sum[j] += texel[j];
    }
  } else {
    for (std::size_t i = 0; i < image.texels.size(); i += 4) {
      for (std::size_t j = 0; j < 3; ++j) sum[j] += std::to_integer<int>(image.texels[i + j]);
    }
  }
  const double texels = static_cast<double>(image.texels.size() / texel_bytes(image.format));
  const double scale = 1.0 / (white * texels);
  return {static_cast<float>(scale * sum[0]), static_cast<float>(scale * sum[1]),
          static_cast<float>(scale * sum[2])};
}

}  // namespace pt::gltf
