// Images whose components are numbers of their own.
#include <cstring>
#include <utility>

#include "common/scene/load/files/images/image_files.h"
#include "common/texture/sample_texture.h"

namespace pt {
namespace {

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
  TextureImage result{TextureFormat::rgb32f, image.width, image.height, {}};
  result.texels.resize(std::size_t{12} * image.width * image.height);
  result.alpha = std::move(image.alpha);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const Color grey(dot(weights, load_texel(look, image.texels.data(), x, y)));
      const std::size_t offset = std::size_t{12} * (std::size_t{y} * image.width + x);
      std::memcpy(result.texels.data() + offset, &grey, sizeof grey);
    }
  }
  return result;
}

}  // namespace pt
