// BMP, TGA and Radiance's .hdr through stb_image, which this file alone contains.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <set>

#include "common/error/error.h"
#include "common/image/codecs/image_codec.h"

namespace pt {
namespace {

/// Owns what stb_image allocates in this thread as long as it lives, so that an exception may pass
/// through stb_image, which is C.
class StbMemory {
 public:
  StbMemory() { current = this; }
  StbMemory(const StbMemory&) = delete;
  StbMemory& operator=(const StbMemory&) = delete;
  ~StbMemory() {
    for (void* block : blocks_) std::free(block);
    current = nullptr;
  }

  void* resize(void* block, std::size_t size) {
    const bool known = blocks_.erase(block) > 0;
    void* resized = std::realloc(block, size);
    if (resized) blocks_.insert(resized);
    if (!resized && known) blocks_.insert(block);
    return resized;
  }
  void free(void* block) {
    blocks_.erase(block);
    std::free(block);
  }

  static thread_local StbMemory* current;

 private:
  std::set<void*> blocks_;
};
thread_local StbMemory* StbMemory::current = nullptr;

}  // namespace
}  // namespace pt

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC  // other libraries contain it as well
#define STBI_ONLY_BMP
#define STBI_ONLY_TGA
#define STBI_ONLY_HDR
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 65535
#define STBI_MALLOC(size) pt::StbMemory::current->resize(nullptr, size)
#define STBI_REALLOC(block, size) pt::StbMemory::current->resize(block, size)
#define STBI_FREE(block) pt::StbMemory::current->free(block)
#include <stb/stb_image.h>

namespace pt {
namespace {

static_assert(STBI_MAX_DIMENSIONS == max_image_size);

/// A file in memory that throws Error when the decoder wants more than there is: stb_image itself
/// would go on with zeros, in an .hdr for ever.
class Source {
 public:
  explicit Source(std::string_view bytes) : bytes_(bytes) {}

  static int read(void* user, char* data, int size) {
    auto& source = *static_cast<Source*>(user);
    const std::size_t wanted = static_cast<std::size_t>(std::max(size, 0));
    const std::size_t count = std::min(wanted, source.rest());
    // Its buffer may be filled in part, but is refilled only when all of it has been used.
    if (count == 0 || (count < wanted && size != buffer_bytes)) fail();
    std::memcpy(data, source.bytes_.data() + source.position_, count);
    source.position_ += count;
    return static_cast<int>(count);
  }

  /// A negative size gives back what was read ahead.
  static void skip(void* user, int size) {
    auto& source = *static_cast<Source*>(user);
    const std::int64_t position = static_cast<std::int64_t>(source.position_) + size;
    if (position < 0 || position > static_cast<std::int64_t>(source.bytes_.size())) fail();
    source.position_ = static_cast<std::size_t>(position);
  }

  static int at_end(void* user) { return static_cast<const Source*>(user)->rest() == 0; }

 private:
  static constexpr int buffer_bytes = sizeof(stbi__context::buffer_start);

  [[noreturn]] static void fail() { throw Error("truncated or corrupted"); }
  std::size_t rest() const { return bytes_.size() - position_; }

  std::string_view bytes_;
  std::size_t position_ = 0;
};

constexpr stbi_io_callbacks callbacks{Source::read, Source::skip, Source::at_end};

/// Lets stb_image read `bytes` by load_pixels(callbacks, source, &width, &height, &channels). The
/// result is the StbMemory's.
template <class Value, class Load>
const Value* load(std::string_view bytes, int& width, int& height, Load load_pixels) {
  int channels = 0;
  Source header(bytes);
  if (bytes.empty() ||
      stbi_info_from_callbacks(&callbacks, &header, &width, &height, &channels) == 0) {
    throw Error("not a PNG, JPEG, BMP, TGA, PPM, PFM, Radiance or OpenEXR image, or corrupted");
  }
  const double decoded_bytes = 4.0 * sizeof(Value) * width * height;  // by stb_image, and a copy
  check_image_size({width, height, decoded_bytes, 2 * decoded_bytes}, bytes.size());
  Source source(bytes);
  const Value* pixels = load_pixels(&callbacks, &source, &width, &height, &channels);
  if (!pixels) throw Error(fmt::format("corrupted: {}", stbi_failure_reason()));
  return pixels;
}

}  // namespace

IntegerImage decode_bmp_or_tga(std::string_view bytes) {
  StbMemory memory;
  IntegerImage image;
  const auto* pixels = load<stbi_uc>(bytes, image.width, image.height, [](auto... arguments) {
    return stbi_load_from_callbacks(arguments..., 4);
  });
  const auto* begin = reinterpret_cast<const std::byte*>(pixels);
  image.rgba.assign(begin, begin + std::size_t{4} * image.width * image.height);
  return image;
}

Image decode_hdr(std::string_view bytes) {
  StbMemory memory;
  Image image;
  const float* pixels = load<float>(bytes, image.width, image.height, [](auto... arguments) {
    return stbi_loadf_from_callbacks(arguments..., 3);
  });
  image.rgb.assign(pixels, pixels + std::size_t{3} * image.width * image.height);
  return image;
}

}  // namespace pt
