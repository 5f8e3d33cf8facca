#include <ImfVersion.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "common/error/error.h"
#include "common/image/codecs/exr.h"

namespace pt {
namespace {

/// The rest of a header or of an attribute.
class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : rest_(bytes) {}

  std::string_view take(std::uint64_t size) {
    if (size > rest_.size()) throw Error("truncated or corrupted in the header");
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }

  std::uint32_t number() {
    std::uint32_t value = 0;
    int shift = 0;
    for (const char byte : take(4)) {
      value |= static_cast<std::uint32_t>(static_cast<unsigned char>(byte)) << shift;
      shift += 8;
    }
    return value;
  }

  /// A text that ends with a zero byte.
  std::string_view text() {
    const std::size_t size = rest_.find('\0');
    if (size == rest_.npos) throw Error("truncated or corrupted in the header");
    return take(size + 1).substr(0, size);
  }

  bool empty() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

struct TypeSize {
  std::string_view type;
  std::size_t bytes;
};
constexpr TypeSize type_sizes[] = {{"box2f", 16},      {"box2i", 16},   {"chromaticities", 32},
                                   {"compression", 1}, {"double", 8},   {"envmap", 1},
                                   {"float", 4},       {"int", 4},      {"keycode", 28},
                                   {"lineOrder", 1},   {"m33f", 36},    {"m33d", 72},
                                   {"m44f", 64},       {"m44d", 128},   {"rational", 8},
                                   {"v2i", 8},         {"v2f", 8},      {"v2d", 16},
                                   {"v3i", 12},        {"v3f", 12},     {"v3d", 24},
                                   {"tiledesc", 9},    {"timecode", 8}, {"deepImageState", 1}};

/// False where a value is not as its type says. Without this OpenEXR, which reads as much as the
/// type needs, would go on at another place than we do.
bool has_its_size(std::string_view type, std::string_view value) {
  for (const TypeSize& known : type_sizes) {
    if (known.type == type) return value.size() == known.bytes;
  }
  Bytes bytes(value);
  if (type == "chlist") {
    while (!bytes.text().empty()) bytes.take(16);
  } else if (type == "stringvector") {
    while (!bytes.empty()) bytes.take(bytes.number());
  } else if (type == "preview") {
    const std::uint64_t width = bytes.number(), height = bytes.number();
    bytes.take(width < 65536 && height < 65536 ? 4 * width * height : ~std::uint64_t{0});
  } else {
    return type != "idmanifest";  // of deep images; other types have any size
  }
  return bytes.empty();
}

/// Refuses what is not a flat, single-part EXR.
void check_kind(std::string_view bytes) {
  if (bytes.size() < 8) throw Error("not an OpenEXR file, or truncated: it is too short");
  Bytes words(bytes);
  if (words.number() != Imf::MAGIC) throw Error("not an OpenEXR file: wrong magic number");
  if (words.number() & (Imf::NON_IMAGE_FLAG | Imf::MULTI_PART_FILE_FLAG)) {
    throw Error("deep or multi-part OpenEXR; expected a flat one with a single part");
  }
}

/// The rest of a box2i, or of the numbers with which a tiledesc begins.
std::int64_t next_integer(Bytes& bytes) { return static_cast<std::int32_t>(bytes.number()); }

/// Decompressed, of all channels.
std::size_t bytes_per_pixel(std::string_view channels) {
  std::size_t bytes = 0;
  for (Bytes list(channels); !list.text().empty();) {
    constexpr std::uint32_t half = 1;  // of the types 0, 1 and 2
    bytes += Bytes(list.take(16)).number() == half ? 2 : 4;
  }
  return bytes;
}

/// OpenEXR allocates the table of offsets, and lines or tiles, before it reads them.
void check_parts(const ExrSize& size, std::size_t file_bytes) {
  const auto over = [](std::int64_t pixels, std::int64_t part) { return (pixels - 1) / part + 1; };
  const std::int64_t parts = size.tile_width == 0 ? 1
                                                  : over(size.width, size.tile_width) *
                                                        over(size.height, size.tile_height);
  if (parts * 8 > static_cast<std::int64_t>(file_bytes)) {
    throw Error(fmt::format("{} bytes cannot hold the {} tiles that the header announces",
                            file_bytes, parts));
  }
}

}  // namespace

ExrSize check_exr_header(std::string_view bytes) {
  check_kind(bytes);
  ExrSize size;
  Bytes header(bytes.substr(8));
  for (std::string_view name; !(name = header.text()).empty();) {
    const std::string_view type = header.text();
    const std::string_view value = header.take(header.number());
    if (!has_its_size(type, value)) {
      throw Error(fmt::format("corrupted in the header: attribute {} is no {}", clipped(name, 40),
                              clipped(type, 40)));
    }
    Bytes numbers(value);
    if (name == "dataWindow" && type == "box2i") {
      const std::int64_t left = next_integer(numbers), head = next_integer(numbers);
      size.width = next_integer(numbers) - left + 1;
      size.height = next_integer(numbers) - head + 1;
    } else if (name == "tiles" && type == "tiledesc") {
      size.tile_width = std::max<std::int64_t>(numbers.number(), 1);
      size.tile_height = std::max<std::int64_t>(numbers.number(), 1);
    } else if (name == "channels" && type == "chlist") {
      size.bytes_per_pixel = bytes_per_pixel(value);
    }
  }
  if (size.width >= 1 && size.height >= 1) check_parts(size, bytes.size());
  return size;
}

}  // namespace pt
