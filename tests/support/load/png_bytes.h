// PNG files chunk by chunk, by zlib and not by libpng, which reads them.
#pragma once

#include <zlib.h>

#include <cstdint>
#include <string>

namespace pt {

inline std::string big_endian_32(std::uint32_t value) {
  return {static_cast<char>(value >> 24), static_cast<char>(value >> 16),
          static_cast<char>(value >> 8), static_cast<char>(value)};
}

inline std::string png_chunk(const std::string& name, const std::string& bytes) {
  const std::string body = name + bytes;
  const auto* data = reinterpret_cast<const Bytef*>(body.data());
  const uLong sum = crc32(0, data, static_cast<uInt>(body.size()));
  return big_endian_32(static_cast<std::uint32_t>(bytes.size())) + body +
         big_endian_32(static_cast<std::uint32_t>(sum));
}

/// `rows`: samples, packed as PNG packs them; each row is stored without a filter. `more`: chunks
/// before the pixels.
inline std::string png_file(std::uint32_t width, std::uint32_t height, int bit_depth,
                            int color_type, const std::string& rows, const std::string& more = "") {
  const std::size_t row_bytes = height == 0 ? 0 : rows.size() / height;
  std::string filtered;
  for (std::size_t at = 0; at < rows.size(); at += row_bytes) {
    filtered += '\0' + rows.substr(at, row_bytes);
  }
  uLongf size = compressBound(filtered.size());
  std::string packed(size, '\0');
  compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
            reinterpret_cast<const Bytef*>(filtered.data()), filtered.size(), 9);
  packed.resize(size);
  std::string header = big_endian_32(width) + big_endian_32(height);
  header += static_cast<char>(bit_depth);
  header += static_cast<char>(color_type);
  header += std::string(3, '\0');
  return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header) + more + png_chunk("IDAT", packed) +
         png_chunk("IEND", "");
}

}  // namespace pt
