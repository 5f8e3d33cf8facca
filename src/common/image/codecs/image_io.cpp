#include "common/image/codecs/image_io.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <new>
#include <system_error>

#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/image/atomic_file.h"
#include "common/image/codecs/image_codec.h"

namespace pt {
namespace {

const ImageCodec* const codecs[] = {&exr_codec, &png_codec, &ppm_codec};

const ImageCodec& codec_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  for (char& c : ending) c = 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  for (const ImageCodec* codec : codecs) {
    if (codec->ending == ending) return *codec;
  }
  throw Error(fmt::format("{}: expected an image file ending in .exr, .png or .ppm", path));
}

void check_metadata(const ImageMetadata& metadata) {
  for (const auto& [key, value] : metadata) {
    // The rules of PNG, the strictest of the formats.
    const bool printable =
        std::all_of(key.begin(), key.end(), [](char c) { return ' ' <= c && c <= '~'; });
    if (!printable || key.empty() || key.size() > 79 || key.front() == ' ' || key.back() == ' ' ||
        key.find("  ") != std::string::npos) {
      throw Error(fmt::format("metadata key '{}' is not 1 to 79 printable ASCII characters", key));
    }
    if (value.find('\0') != std::string::npos) {
      throw Error(fmt::format("metadata value of '{}' contains a zero byte", key));
    }
  }
}

void check_image(const Image& image) {
  const auto is_size = [](int size) { return 0 < size && size <= max_image_size; };
  if (!is_size(image.width) || !is_size(image.height) ||
      image.rgb.size() != std::size_t{3} * image.width * image.height) {
    throw Error(fmt::format("image of {}x{} pixels with {} values; expected sides of 1 to {}",
                            image.width, image.height, image.rgb.size(), max_image_size));
  }
  const std::size_t pixels = image.rgb.size() / 3;
  for (const ImageLayer& layer : image.layers) {
    const std::size_t values = layer.values.size() + layer.numbers.size();
    if (layer.channels.empty() || values != pixels * layer.channels.size()) {
      throw Error(fmt::format("layer {} of {} values in an image of {} pixels", layer.name, values,
                              pixels));
    }
  }
}

std::string read_file(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) throw Error(std::generic_category().message(errno));
  if (!S_ISREG(status.st_mode)) throw Error("not a regular file");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(std::generic_category().message(errno));
  std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
  if (!file.read(bytes.data(), status.st_size))
    throw Error("the file could not be read to its end");
  return bytes;
}

}  // namespace

void check_image_size(const AnnouncedSize& size, std::size_t file_bytes) {
  const std::int64_t width = size.width, height = size.height;
  if (width < 1 || height < 1 || width > max_image_size || height > max_image_size) {
    throw Error(fmt::format("image of {}x{} pixels; expected sides of 1 to {}", width, height,
                            max_image_size));
  }
  // Deflate yields at most 1032 bytes for one; the constant is for lossy EXR, which yields more.
  const double believable_bytes = 1032.0 * static_cast<double>(file_bytes) + 0x1p28;
  if (size.stored_bytes > believable_bytes) {
    throw Error(fmt::format("{} bytes cannot hold the {}x{} pixels that the header announces",
                            file_bytes, width, height));
  }
  constexpr std::int64_t most_pixels = 1 << 28, most_per_byte = 256;
  const auto believable = static_cast<std::int64_t>(file_bytes) * most_per_byte;
  if (width * height > std::max(most_pixels, believable)) {
    throw Error(fmt::format(
        "{}x{} pixels in {} bytes; expected at most 2^28 (16384x16384), or {} for each byte of the "
        "file: a larger image of little content must be stored with less compression",
        width, height, file_bytes, most_per_byte));
  }
  check_host_memory(static_cast<std::uint64_t>(size.decoding_bytes),
                    fmt::format("an image of {}x{} pixels", width, height));
}

Image allocate_image(AnnouncedSize size, std::size_t file_bytes) {
  const double values = 3.0 * static_cast<double>(size.width) * static_cast<double>(size.height);
  size.decoding_bytes += sizeof(float) * values;
  check_image_size(size, file_bytes);
  Image image{static_cast<int>(size.width), static_cast<int>(size.height), {}};
  image.rgb.resize(static_cast<std::size_t>(3 * size.width * size.height));
  return image;
}

std::string image_ending(const std::string& path) { return std::string(codec_of(path).ending); }

void check_image_path(const std::string& path) {
  codec_of(path);
  check_writable(path);
}

void write_image(const std::string& path, const Image& image, const ImageMetadata& metadata,
                 const ToneMapping& tone_mapping) {
  const ImageCodec& codec = codec_of(path);
  const std::string bytes = explaining("cannot write " + path, [&] {
    check_image(image);
    check_metadata(metadata);
    return codec.encode(image, metadata, tone_mapping);
  });
  write_file_atomically(path, bytes);
}

Image read_image(const std::string& path, ImageMetadata* metadata) {
  const ImageCodec& codec = codec_of(path);
  return explaining("cannot read " + path, [&] {
    ImageMetadata found;
    Image image = codec.decode(read_file(path), &found);
    if (metadata) *metadata = std::move(found);
    return image;
  });
}

Image read_image_with_layers(const std::string& path, ImageMetadata& metadata) {
  if (image_ending(path) != ".exr") return read_image(path, &metadata);
  return explaining("cannot read " + path,
                    [&] { return decode_exr_layers(read_file(path), &metadata); });
}

Image read_image_with_numbers(const std::string& path, const std::string& prefix,
                              ImageMetadata& metadata) {
  return explaining("cannot read " + path,
                    [&] { return decode_exr_numbers(read_file(path), prefix, &metadata); });
}

}  // namespace pt
