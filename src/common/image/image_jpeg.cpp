// JPEG through libjpeg, which bears broken files; stb_image's decoder writes past its tables.
// jpeglib.h uses what it does not include:
// clang-format off
#include <cstdio>
#include <jpeglib.h>
#include <jerror.h>
// clang-format on

#include <csetjmp>

#include "common/error.h"
#include "common/image/image_codec.h"
#include "common/image/rgba8.h"

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

}  // namespace

Rgba8Image decode_jpeg(std::string_view bytes) {
  JpegReader reader;
  reader.open(bytes);
  jpeg_decompress_struct& jpeg = reader.jpeg;
  // A block of 64 pixels takes a bit or more, of one component or several.
  const double pixels = static_cast<double>(jpeg.image_width) * jpeg.image_height;
  check_image_size(jpeg.image_width, jpeg.image_height, 4 * pixels, bytes.size());
  if (pixels / 512 > static_cast<double>(bytes.size())) throw Error("truncated or corrupted");
  reader.attempt([&] {
    jpeg.out_color_space = JCS_RGB;
    jpeg_start_decompress(&jpeg);
  });

  const std::size_t width = jpeg.output_width, height = jpeg.output_height;
  Rgba8Image image{static_cast<int>(width), static_cast<int>(height), {}};
  image.rgba.resize(4 * width * height, std::byte{255});
  std::vector<unsigned char> row(3 * width);
  reader.attempt([&] {
    unsigned char* rows[] = {row.data()};
    std::byte* out = image.rgba.data();
    while (jpeg.output_scanline < jpeg.output_height) {
      jpeg_read_scanlines(&jpeg, rows, 1);
      for (std::size_t x = 0; x < width; ++x, out += 4) {
        for (std::size_t c = 0; c < 3; ++c) out[c] = std::byte{row[3 * x + c]};
      }
    }
    jpeg_finish_decompress(&jpeg);
  });
  return image;
}

}  // namespace pt
