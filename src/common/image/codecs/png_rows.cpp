#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <new>

#include "common/image/codecs/png_codec.h"

namespace pt {
namespace {

constexpr std::size_t block_bytes = std::size_t{1} << 16;   // smaller ones cost no bytes
constexpr std::size_t window_bytes = std::size_t{1} << 15;  // that a block sees of the one before

using Byte = unsigned char;

enum class RowFilter : Byte { none, sub, up, average, paeth };  // with the values of the format
constexpr std::array all_filters{RowFilter::none, RowFilter::sub, RowFilter::up, RowFilter::average,
                                 RowFilter::paeth};

Byte predict_paeth(int left, int above, int above_left) {
  const int p = left + above - above_left;
  const int to_left = std::abs(p - left), to_above = std::abs(p - above),
            to_corner = std::abs(p - above_left);
  if (to_left <= to_above && to_left <= to_corner) return static_cast<Byte>(left);
  return static_cast<Byte>(to_above <= to_corner ? above : above_left);
}

/// What the filter leaves of a row behind its own number; `above` is null for the first row.
template <RowFilter filter>
void filter_row(const Byte* row, const Byte* above, std::size_t row_bytes, std::size_t pixel_bytes,
                Byte* result) {
  *result++ = static_cast<Byte>(filter);
  for (std::size_t i = 0; i < row_bytes; ++i) {
    const bool has_left = i >= pixel_bytes;
    const int left = has_left ? row[i - pixel_bytes] : 0;
    const int up = above != nullptr ? above[i] : 0;
    const int corner = has_left && above != nullptr ? above[i - pixel_bytes] : 0;
    int predicted = 0;
    if constexpr (filter == RowFilter::sub) predicted = left;
    if constexpr (filter == RowFilter::up) predicted = up;
    if constexpr (filter == RowFilter::average) predicted = (left + up) / 2;
    if constexpr (filter == RowFilter::paeth) predicted = predict_paeth(left, up, corner);
    result[i] = static_cast<Byte>(row[i] - predicted);
  }
}

void filter_row_by(RowFilter filter, const Byte* row, const Byte* above, std::size_t row_bytes,
                   std::size_t pixel_bytes, Byte* result) {
  using enum RowFilter;
  switch (filter) {
    case none:
      return filter_row<none>(row, above, row_bytes, pixel_bytes, result);
    case sub:
      return filter_row<sub>(row, above, row_bytes, pixel_bytes, result);
    case up:
      return filter_row<up>(row, above, row_bytes, pixel_bytes, result);
    case average:
      return filter_row<average>(row, above, row_bytes, pixel_bytes, result);
    case paeth:
      return filter_row<paeth>(row, above, row_bytes, pixel_bytes, result);
  }
}

/// How far the bytes are from 0, as differences.
std::uint64_t sum_of_differences(const Byte* bytes, std::size_t count) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += bytes[i] < 128 ? bytes[i] : 256 - bytes[i];
  return sum;
}

/// A byte and `row_bytes` for each row.
std::vector<Byte> filter_rows(std::string_view samples, std::size_t row_bytes,
                              std::size_t pixel_bytes, bool chooses) {
  const std::size_t rows = samples.size() / row_bytes, filtered_bytes = row_bytes + 1;
  std::vector<Byte> filtered(rows * filtered_bytes);
  const auto* const begin = reinterpret_cast<const Byte*>(samples.data());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows), [&](const auto& range) {
    std::vector<Byte> trial(filtered_bytes);
    for (std::size_t y = range.begin(); y < range.end(); ++y) {
      const Byte* const row = begin + y * row_bytes;
      const Byte* const above = y > 0 ? row - row_bytes : nullptr;
      Byte* const result = &filtered[y * filtered_bytes];
      if (!chooses) {
        filter_row_by(RowFilter::sub, row, above, row_bytes, pixel_bytes, result);
        continue;
      }
      std::uint64_t best = std::numeric_limits<std::uint64_t>::max();
      for (const RowFilter filter : all_filters) {
        filter_row_by(filter, row, above, row_bytes, pixel_bytes, trial.data());
        const std::uint64_t sum = sum_of_differences(trial.data() + 1, row_bytes);
        if (sum >= best) continue;
        best = sum;
        std::copy(trial.begin(), trial.end(), result);
      }
    }
  });
  return filtered;
}

/// A deflate stream that is ended when it is left.
class Deflater {
 public:
  explicit Deflater(int level) {
    constexpr int without_header = -15, memory = 8;
    if (deflateInit2(&stream_, level, Z_DEFLATED, without_header, memory, Z_FILTERED) != Z_OK)
      throw std::bad_alloc();
  }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;
  ~Deflater() { deflateEnd(&stream_); }

  /// Bytes [first, end) of `bytes`, which know those before them. All but the last block end at a
  /// whole byte.
  std::string compress(const std::vector<Byte>& bytes, std::size_t first, std::size_t end) {
    const std::size_t known = std::min(first, window_bytes);
    if (known > 0) deflateSetDictionary(&stream_, &bytes[first - known], static_cast<uInt>(known));
    const auto length = static_cast<uInt>(end - first);
    std::string result(deflateBound(&stream_, length) + 16, '\0');  // 16: the flush's marker
    stream_.next_in = const_cast<Byte*>(&bytes[first]);
    stream_.avail_in = length;
    stream_.next_out = reinterpret_cast<Byte*>(result.data());
    stream_.avail_out = static_cast<uInt>(result.size());
    deflate(&stream_, end == bytes.size() ? Z_FINISH : Z_SYNC_FLUSH);
    result.resize(result.size() - stream_.avail_out);
    return result;
  }

 private:
  z_stream stream_{};
};

std::string big_endian(uLong value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
  return bytes;
}

}  // namespace

std::vector<std::string> compress_png_rows(std::string_view samples, std::size_t row_bytes,
                                           std::size_t pixel_bytes,
                                           const PngCompression& compression) {
  const std::vector<Byte> filtered =
      filter_rows(samples, row_bytes, pixel_bytes, compression.chooses_filters);
  const std::size_t count = (filtered.size() + block_bytes - 1) / block_bytes;
  std::vector<std::string> blocks(count);
  std::vector<uLong> sums(count);
  const auto end_of = [&](std::size_t i) {
    return std::min(filtered.size(), (i + 1) * block_bytes);
  };
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    const std::size_t first = i * block_bytes;
    blocks[i] = Deflater(compression.level).compress(filtered, first, end_of(i));
    sums[i] = adler32_z(adler32(0, nullptr, 0), &filtered[first], end_of(i) - first);
  });
  uLong sum = sums.front();
  for (std::size_t i = 1; i < count; ++i) {
    sum = adler32_combine(sum, sums[i], static_cast<z_off_t>(end_of(i) - i * block_bytes));
  }
  blocks.front().insert(0, "\x78\x9c");  // deflate, a window of 32 KiB, the usual level
  blocks.back() += big_endian(sum);
  return blocks;
}

}  // namespace pt
