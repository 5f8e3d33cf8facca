// BMP, TGA and Radiance's .hdr through stb_image, which this file alone contains.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "common/error.h"
#include "common/image/image_codec.h"
#include "common/image/rgba8.h"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC  // other libraries contain it as well
#define STBI_ONLY_BMP
#define STBI_ONLY_TGA
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 65535
#include <stb/stb_image.h>

namespace pt {
namespace {

static_assert(STBI_MAX_DIMENSIONS == max_image_size);

/// A file in memory that notices when the decoder wants more than there is: stb_image itself goes
/// on with zeros.
class Source {
 public:
  explicit Source(std::string_view bytes) : bytes_(bytes) {}

  static int read(void* user, char* data, int size) {
    auto& source = *static_cast<Source*>(user);
    const std::size_t rest = source.bytes_.size() - source.position_;
    const std::size_t count = std::min(rest, static_cast<std::size_t>(std::max(size, 0)));
    // Its buffer may be filled in part, but is refilled only when all of it has been used.
    if (count == 0 || (count < static_cast<std::size_t>(size) && size != buffer_bytes)) {
      source.past_end = true;
    }
    std::memcpy(data, source.bytes_.data() + source.position_, count);
    source.position_ += count;
    return static_cast<int>(count);
  }

  static void skip(void* user, int size) {
    auto& source = *static_cast<Source*>(user);
    const std::size_t rest = source.bytes_.size() - source.position_;
    // A negative size gives back what was read ahead.
    const std::size_t back = size < 0 ? static_cast<std::size_t>(-std::int64_t{size}) : 0;
    if (size < 0) {
      source.position_ -= std::min(back, source.position_);
    } else {
      if (static_cast<std::size_t>(size) > rest) source.past_end = true;
      source.position_ += std::min(rest, static_cast<std::size_t>(size));
    }
  }

  static int at_end(void* user) {
    const auto& source = *static_cast<const Source*>(user);
    return source.position_ == source.bytes_.size();
  }

  bool past_end = false;

 private:
  static constexpr int buffer_bytes = sizeof(stbi__context::buffer_start);

  std::string_view bytes_;
  std::size_t position_ = 0;
};

constexpr stbi_io_callbacks callbacks{Source::read, Source::skip, Source::at_end};

/// Lets stb_image read `bytes` by load(callbacks, source, &width, &height, &channels), which
/// returns `channels_wanted` values a pixel.
template <class Value, class Load>
std::unique_ptr<Value, void (*)(void*)> load(std::string_view bytes, int& width, int& height,
                                             Load load_pixels) {
  int channels = 0;
  Source header(bytes);
  if (bytes.empty() ||
      stbi_info_from_callbacks(&callbacks, &header, &width, &height, &channels) == 0) {
    throw Error("not a PNG, JPEG, BMP, TGA, Radiance or OpenEXR image, or corrupted");
  }
  const double decoded_bytes = 4.0 * sizeof(Value) * width * height;
  check_image_size(width, height, decoded_bytes, bytes.size());
  Source source(bytes);
  std::unique_ptr<Value, void (*)(void*)> pixels(
      load_pixels(&callbacks, &source, &width, &height, &channels), stbi_image_free);
  if (source.past_end) throw Error("truncated or corrupted");
  if (!pixels) throw Error(fmt::format("corrupted: {}", stbi_failure_reason()));
  return pixels;
}

}  // namespace

Rgba8Image decode_bmp_or_tga(std::string_view bytes) {
  Rgba8Image image;
  const auto pixels = load<stbi_uc>(bytes, image.width, image.height, [](auto... arguments) {
    return stbi_load_from_callbacks(arguments..., 4);
  });
  const auto* begin = reinterpret_cast<const std::byte*>(pixels.get());
  image.rgba.assign(begin, begin + std::size_t{4} * image.width * image.height);
  return image;
}

Image decode_hdr(std::string_view bytes) {
  Image image;
  const auto pixels = load<float>(bytes, image.width, image.height, [](auto... arguments) {
    return stbi_loadf_from_callbacks(arguments..., 3);
  });
  image.rgb.assign(pixels.get(), pixels.get() + std::size_t{3} * image.width * image.height);
  return image;
}

}  // namespace pt
