// PNG through libpng.
#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstring>
#include <new>
#include <vector>

#include "common/error/error.h"
#include "common/image/codecs/image_codec.h"
#include "common/image/codecs/png_codec.h"
#include "common/image/tone_mapping.h"

namespace pt {
namespace {

void on_error(png_structp png, png_const_charp message) {
  auto& session = *static_cast<PngSession*>(png_get_error_ptr(png));
  std::snprintf(session.message, sizeof session.message, "%s", message);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}  // libpng would print it

void on_read(png_structp png, png_bytep data, std::size_t size) {
  std::string_view& input = static_cast<PngSession*>(png_get_io_ptr(png))->input;
  if (size > input.size()) png_error(png, "truncated");
  std::memcpy(data, input.data(), size);
  input.remove_prefix(size);
}

void on_write(png_structp png, png_bytep data, std::size_t size) {
  bool full = false;
  try {
    std::string& output = static_cast<PngSession*>(png_get_io_ptr(png))->output;
    output.append(reinterpret_cast<const char*>(data), size);
  } catch (const std::exception&) {
    full = true;  // reported after the handler: a longjmp out of it would leak the exception
  }
  if (full) png_error(png, "not enough memory");
}

}  // namespace

PngReader::PngReader(std::string_view bytes) {
  session.input = bytes;
  png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &session, on_error, on_warning);
  if (!png) throw std::bad_alloc();
  info = png_create_info_struct(png);
  if (!info) {
    png_destroy_read_struct(&png, nullptr, nullptr);
    throw std::bad_alloc();
  }
  png_set_read_fn(png, &session, on_read);
}

PngWriter::PngWriter() {
  png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &session, on_error, on_warning);
  if (!png) throw std::bad_alloc();
  info = png_create_info_struct(png);
  if (!info) {
    png_destroy_write_struct(&png, nullptr);
    throw std::bad_alloc();
  }
  png_set_write_fn(png, &session, on_write, nullptr);
}

namespace {

bool is_ascii(const std::string& text) {
  return std::ranges::all_of(text, [](unsigned char c) { return c < 0x80; });
}

/// Points into `metadata`.
std::vector<png_text> text_chunks(const ImageMetadata& metadata) {
  std::vector<png_text> chunks;
  for (const auto& [key, value] : metadata) {
    png_text chunk{};
    // tEXt is Latin-1; iTXt is UTF-8.
    chunk.compression = is_ascii(value) ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;
    chunk.key = const_cast<char*>(key.c_str());
    chunk.text = const_cast<char*>(value.c_str());
    chunk.text_length = value.size();
    chunks.push_back(chunk);
  }
  return chunks;
}

void write_chunk(png_structp png, const char* name, const std::string& bytes) {
  png_write_chunk(png, reinterpret_cast<png_const_bytep>(name),
                  reinterpret_cast<png_const_bytep>(bytes.data()), bytes.size());
}

std::string encode(const Image& image, const ImageMetadata& metadata,
                   const ToneMapping& tone_mapping, const PngCompression& compression) {
  constexpr std::size_t pixel_bytes = 3;
  const std::size_t row_bytes = pixel_bytes * static_cast<std::size_t>(image.width);
  const std::vector<std::string> pixels = compress_png_rows(
      quantize(image, tone_mapping, srgb_curve), row_bytes, pixel_bytes, compression);
  const std::string nothing;
  const std::vector<png_text> texts = text_chunks(metadata);
  PngWriter writer;
  attempt(writer, [&](png_structp png, png_infop info) {
    png_set_IHDR(png, info, image.width, image.height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_BASE, PNG_FILTER_TYPE_BASE);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_set_text(png, info, texts.data(), static_cast<int>(texts.size()));
    png_write_info(png, info);
    for (const std::string& block : pixels) write_chunk(png, "IDAT", block);
    write_chunk(png, "IEND", nothing);
  });
  return std::move(writer.session.output);
}

std::string encode_png(const Image& image, const ImageMetadata& metadata,
                       const ToneMapping& tone_mapping) {
  return encode(image, metadata, tone_mapping, {});
}

/// libpng allocates what the length of a chunk announces: refuses lengths past the file's end.
void check_chunks(std::string_view bytes) {
  if (!bytes.starts_with("\x89PNG\r\n\x1a\n")) {
    throw Error("not a PNG: it does not begin with the PNG signature");
  }
  for (std::string_view rest = bytes.substr(8); !rest.empty();) {
    // A chunk: length, name, as many bytes as the length says, checksum.
    const std::size_t length =
        rest.size() < 12 ? 0 : png_get_uint_32(reinterpret_cast<png_const_bytep>(rest.data()));
    if (rest.size() < 12 || rest.size() - 12 < length) throw Error("truncated or corrupted");
    if (rest.substr(4, 4) == "IEND") return;
    rest.remove_prefix(12 + length);
  }
}

AnnouncedSize read_header(PngReader& reader) {
  AnnouncedSize size;
  attempt(reader, [&](png_structp png, png_infop info) {
    png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);  // check_image_size says it better
    png_read_info(png, info);
    size.width = png_get_image_width(png, info);
    size.height = png_get_image_height(png, info);
    size.stored_bytes = static_cast<double>(png_get_rowbytes(png, info)) *
                        static_cast<double>(png_get_image_height(png, info));
  });
  return size;
}

double pixels_of(const AnnouncedSize& size) {
  return static_cast<double>(size.width) * static_cast<double>(size.height);
}

/// Fills rows of `row_bytes`, set by libpng for the transformations that were asked for.
void read_rows(PngReader& reader, int passes, int height, std::size_t row_bytes, void* rows) {
  attempt(reader, [&](png_structp png, png_infop info) {
    for (int pass = 0; pass < passes; ++pass) {
      auto* row = static_cast<png_bytep>(rows);
      for (int y = 0; y < height; ++y, row += row_bytes) png_read_row(png, row, nullptr);
    }
    png_read_end(png, info);
  });
}

/// Fills `image`, which has the size of the header.
void read_pixels(PngReader& reader, Image& image) {
  int passes = 0, max_value = 0;
  std::size_t row_bytes = 0;
  attempt(reader, [&](png_structp png, png_infop info) {
    png_set_expand(png);  // palettes and fewer than 8 bits
    png_set_strip_alpha(png);
    png_set_gray_to_rgb(png);
    passes = png_set_interlace_handling(png);
    png_read_update_info(png, info);
    max_value = png_get_bit_depth(png, info) == 16 ? 65535 : 255;
    row_bytes = png_get_rowbytes(png, info);
  });
  std::string samples(row_bytes * image.height, '\0');
  read_rows(reader, passes, image.height, row_bytes, samples.data());
  dequantize(samples, max_value, srgb_curve, image);
}

Image decode_png(std::string_view bytes, ImageMetadata* metadata) {
  check_chunks(bytes);
  PngReader reader(bytes);
  AnnouncedSize size = read_header(reader);
  size.decoding_bytes = 6.0 * pixels_of(size);  // samples of 16 bits
  Image image = allocate_image(size, bytes.size());
  read_pixels(reader, image);

  png_textp texts = nullptr;
  const int count = png_get_text(reader.png, reader.info, &texts, nullptr);
  for (int i = 0; i < count; ++i) {
    (*metadata)[texts[i].key] = texts[i].text ? texts[i].text : "";
  }
  return image;
}

}  // namespace

std::string encode_png_fast(const Image& image, const ToneMapping& tone_mapping) {
  return encode(image, {}, tone_mapping, {.level = 1, .chooses_filters = false});
}

IntegerImage decode_png_integers(std::string_view bytes) {
  check_chunks(bytes);
  PngReader reader(bytes);
  AnnouncedSize size = read_header(reader);
  const bool is_wide = png_get_bit_depth(reader.png, reader.info) == 16;
  size.decoding_bytes = (is_wide ? 8.0 : 4.0) * pixels_of(size);
  check_image_size(size, bytes.size());
  int passes = 0;
  attempt(reader, [&](png_structp png, png_infop info) {
    png_set_expand(png);  // palettes, transparent colours and fewer than 8 bits
    png_set_gray_to_rgb(png);
    png_set_add_alpha(png, 0xffff, PNG_FILLER_AFTER);
    if (std::endian::native == std::endian::little) png_set_swap(png);
    passes = png_set_interlace_handling(png);
    png_read_update_info(png, info);
  });
  IntegerImage image{static_cast<int>(size.width), static_cast<int>(size.height), {}};
  const std::size_t row = std::size_t{4} * image.width;
  if (is_wide) {
    image.rgba16.resize(row * image.height);
    read_rows(reader, passes, image.height, 2 * row, image.rgba16.data());
    image.narrow();
  } else {
    image.rgba.resize(row * image.height);
    read_rows(reader, passes, image.height, row, image.rgba.data());
  }
  return image;
}

void IntegerImage::narrow() {
  if (!std::ranges::all_of(rgba16, [](std::uint16_t value) { return value % 257 == 0; })) return;
  rgba.resize(rgba16.size());
  std::ranges::transform(rgba16, rgba.begin(), [](std::uint16_t v) { return std::byte(v / 257); });
  rgba16 = {};
}

const ImageCodec png_codec{".png", encode_png, decode_png};

}  // namespace pt
