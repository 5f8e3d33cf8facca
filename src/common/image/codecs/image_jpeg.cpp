// JPEG through libjpeg, which bears broken files; stb_image's decoder writes past its tables.
// jpeglib.h uses what it does not include:
// clang-format off
#include <cstdio>
#include <jpeglib.h>
#include <jerror.h>
// clang-format on

#include <csetjmp>

#include "common/error/error.h"
#include "common/image/codecs/image_codec.h"

namespace pt {
namespace {

/// libjpeg reports an error by longjmp, which must not pass over destructors: every call that can
/// fail stands inside `attempt`, in a step whose locals are trivial; what owns memory stands
/// outside.
class JpegReader {
 public:
  JpegReader() {
    jpeg.err = jpeg_std_error(&errors_);
    errors_.error_exit = on_error;
    errors_.emit_message = on_message;
    jpeg.client_data = this;
  }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;
  ~JpegReader() { jpeg_destroy_decompress(&jpeg); }

  /// Reads the header. Not the constructor's work: libjpeg's memory is the destructor's to free.
  void open(std::string_view bytes) {
    attempt([&] {
      jpeg_create_decompress(&jpeg);
      jpeg_mem_src(&jpeg, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
      jpeg_read_header(&jpeg, TRUE);
    });
  }

  /// Runs `step`. Throws Error with libjpeg's message.
  template <class Step>
  void attempt(Step step) {
    if (!finishes(step)) throw Error(message_);
  }

  jpeg_decompress_struct jpeg{};

 private:
  /// False when `step` was left by a longjmp.
  template <class Step>
  bool finishes(Step& step) {
    if (setjmp(jump_) != 0) return false;
    step();
    return true;
  }

  [[noreturn]] static void on_error(j_common_ptr common) {
    auto& reader = *static_cast<JpegReader*>(common->client_data);
    common->err->format_message(common, reader.message_);
    std::longjmp(reader.jump_, 1);
  }

  /// Warnings (level -1) are errors, since they speak of missing or wrong data, but for those about
  /// bytes that no decoder needs.
  static void on_message(j_common_ptr common, int level) {
    const int code = common->err->msg_code;
    if (level < 0 && code != JWRN_EXTRANEOUS_DATA && code != JWRN_ADOBE_XFORM) on_error(common);
  }

  jpeg_error_mgr errors_{};
  std::jmp_buf jump_{};
  char message_[JMSG_LENGTH_MAX] = "";
};

/// A pixel of four inks. Adobe's programs store how much of an ink is missing, and say that they
/// wrote the file (libjpeg's libjpeg.txt, 'CMYK').
void put_cmyk(const unsigned char* inks, bool missing, std::byte* rgb) {
  const auto passed = [&](int i) { return missing ? inks[i] : 255 - inks[i]; };
  for (int c = 0; c < 3; ++c) rgb[c] = std::byte((passed(c) * passed(3) + 127) / 255);
}

void put_rgb(const unsigned char* values, std::byte* rgb) {
  for (int c = 0; c < 3; ++c) rgb[c] = std::byte{values[c]};
}

}  // namespace

IntegerImage decode_jpeg(std::string_view bytes) {
  JpegReader reader;
  reader.open(bytes);
  jpeg_decompress_struct& jpeg = reader.jpeg;
  // A block of 64 pixels takes a bit or more, of one component or several.
  const double pixels = static_cast<double>(jpeg.image_width) * jpeg.image_height;
  // A progressive one keeps 16 bits of each coefficient beside the result.
  check_image_size({jpeg.image_width, jpeg.image_height, 4 * pixels, 12 * pixels}, bytes.size());
  if (pixels / 512 > static_cast<double>(bytes.size())) throw Error("truncated or corrupted");
  const bool inks = jpeg.jpeg_color_space == JCS_CMYK || jpeg.jpeg_color_space == JCS_YCCK;
  reader.attempt([&] {
    jpeg.out_color_space = inks ? JCS_CMYK : JCS_RGB;
    jpeg_start_decompress(&jpeg);
  });

  const std::size_t width = jpeg.output_width, height = jpeg.output_height;
  IntegerImage image{static_cast<int>(width), static_cast<int>(height), {}};
  image.rgba.resize(4 * width * height, std::byte{255});
  const std::size_t channels = inks ? 4 : 3;
  std::vector<unsigned char> row(channels * width);
  reader.attempt([&] {
    unsigned char* rows[] = {row.data()};
    std::byte* out = image.rgba.data();
    while (jpeg.output_scanline < jpeg.output_height) {
      jpeg_read_scanlines(&jpeg, rows, 1);
      for (std::size_t x = 0; x < width; ++x, out += 4) {
        const unsigned char* pixel = row.data() + channels * x;
        inks ? put_cmyk(pixel, jpeg.saw_Adobe_marker, out) : put_rgb(pixel, out);
      }
    }
    jpeg_finish_decompress(&jpeg);
  });
  return image;
}

}  // namespace pt
