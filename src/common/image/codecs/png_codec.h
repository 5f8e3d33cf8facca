// libpng's side of the PNG codec: sessions in memory, and errors as exceptions. libpng reports an
// error by longjmp, which must not pass over destructors: every call that can fail stands inside
// `attempt`, in a step whose locals are trivial; what owns memory stands outside.
#pragma once

#include <png.h>

#include <csetjmp>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "common/error/error.h"

namespace pt {

/// The state of libpng's callbacks.
struct PngSession {
  char message[160] = "";
  std::string_view input;  ///< not yet read
  std::string output;
};

/// An open libpng reader of session.input. Throws std::bad_alloc.
struct PngReader {
  explicit PngReader(std::string_view bytes);
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }

  PngSession session;
  png_structp png = nullptr;
  png_infop info = nullptr;
};

/// An open libpng writer to session.output. Throws std::bad_alloc.
struct PngWriter {
  PngWriter();
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;
  ~PngWriter() { png_destroy_write_struct(&png, &info); }

  PngSession session;
  png_structp png = nullptr;
  png_infop info = nullptr;
};

/// False when `step` was left by a longjmp.
template <class Step>
bool finishes(png_structp png, Step& step) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  step();
  return true;
}

/// Runs step(png, info). Throws Error with libpng's message.
template <class Session, class Step>
void attempt(Session& session, Step step) {
  auto bound = [&] { step(session.png, session.info); };
  if (!finishes(session.png, bound)) throw Error(session.session.message);
}

// The pixels of a PNG, filtered and compressed by all cores (libpng uses one): each row chooses its
// filter alone, and a zlib stream may be made of blocks that are compressed side by side, as pigz
// does (RFC 1950, RFC 1951; PNG specification, second edition, 9 and 12.8).

struct PngCompression {
  int level = 4;                ///< of zlib, 0..9; 6: thrice the time, 2 to 7 % fewer bytes
  bool chooses_filters = true;  ///< each row's by what is left of it; else Sub
};

/// One zlib stream, as the contents of IDAT chunks in their order: the same whatever the number of
/// threads. `samples`: rows of `row_bytes`, at least one; `pixel_bytes`: of a pixel, at least 1.
/// Throws std::bad_alloc.
std::vector<std::string> compress_png_rows(std::string_view samples, std::size_t row_bytes,
                                           std::size_t pixel_bytes,
                                           const PngCompression& compression);

}  // namespace pt
