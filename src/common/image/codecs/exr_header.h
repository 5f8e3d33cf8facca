// A look at an OpenEXR header before OpenEXR reads it, which allocates what the file announces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace pt {

/// What it announces. The sides are those of the data window, and may be any numbers.
struct ExrSize {
  std::int64_t width = 0, height = 0;
  std::int64_t tile_width = 0, tile_height = 0;  ///< 0: the file has lines
  std::size_t bytes_per_pixel = 0;               ///< of all channels, decompressed
};

/// Throws Error unless `bytes` begin with the header of a flat, single-part OpenEXR file whose
/// attributes have the sizes of their types and lie within the file, which must be large enough for
/// the offsets of its tiles (https://openexr.com/en/latest/OpenEXRFileLayout.html).
ExrSize check_exr_header(std::string_view bytes);

}  // namespace pt
