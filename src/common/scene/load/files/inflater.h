// A stream of values out of zlib-compressed memory.
#pragma once

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <vector>

namespace pt {

/// Decompresses as much as is asked for, when it is asked for.
class Inflater {
 public:
  /// `bytes` begin with a zlib stream and outlive the inflater. Throws Error.
  explicit Inflater(std::string_view bytes);
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&stream_); }

  /// The next `size` bytes. Throws Error where the stream is corrupted or ends before.
  void read(void* out, std::size_t size);

  template <class T>
  T next() {
    T value;
    read(&value, sizeof value);
    return value;
  }

  /// The next `count` values. Allocates as they arrive, so that a count that is a lie costs no
  /// memory.
  template <class T>
  std::vector<T> next_array(std::uint64_t count) {
    constexpr std::uint64_t step = 1 << 16;
    std::vector<T> values;
    while (values.size() < count) {
      const std::uint64_t before = values.size();
      values.resize(before + std::min(count - before, std::max(before, step)));
      read(values.data() + before, (values.size() - before) * sizeof(T));
    }
    return values;
  }

 private:
  z_stream stream_{};
};

}  // namespace pt
