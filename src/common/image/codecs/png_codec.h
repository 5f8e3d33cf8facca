// libpng's side of the PNG codec: sessions in memory, and errors as exceptions. libpng reports an
// error by longjmp, which must not pass over destructors: every call that can fail stands inside
// `attempt`, in a step whose locals are trivial; what owns memory stands outside.
#pragma once

#include <png.h>

#include <csetjmp>
#include <string>
#include <string_view>

#include "common/error/error.h"

namespace pt {

/// What libpng's callbacks see.
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

}  // namespace pt
