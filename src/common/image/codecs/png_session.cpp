#include <cstdio>
#include <cstring>
#include <new>

#include "common/image/codecs/png_codec.h"

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

}  // namespace pt
