// The pixels of a PNG, filtered and compressed by all cores (libpng does it by one): rows choose
// their filters alone, and a zlib stream may be made of blocks that are compressed side by side, as
// pigz does (RFC 1950, RFC 1951; PNG specification, second edition, 9 and 12.8).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace pt {

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
