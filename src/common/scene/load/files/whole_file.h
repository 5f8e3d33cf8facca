// Files that scenes name: found, read whole, unpacked.
#pragma once

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/error/error.h"

namespace pt {

/// Called with a line about a name that is not exactly that of the file.
using WarnOfName = std::function<void(const std::string&)>;

/// folder / name where that exists. Else what differs from it in the case of ASCII letters within
/// `name` alone (files made on Windows; the first in alphabetical order), of which `warn` is told;
/// else an empty path.
std::filesystem::path find_file(const std::filesystem::path& folder,
                                const std::filesystem::path& name, const WarnOfName& warn);

// A whole file as memory.

/// The bytes of a regular file, read once: a file that is mapped and then becomes shorter, or whose
/// disk fails, ends the program (SIGBUS). Throws Error with the system's reason (without the file's
/// name) where it cannot be read, and where it needs more memory than there is.
class WholeFile {
 public:
  explicit WholeFile(const std::filesystem::path& path);

  std::string_view bytes() const { return bytes_; }

 private:
  std::unique_ptr<char[]> memory_;
  std::string_view bytes_;
};

// A stream of values out of zlib-compressed memory.

/// How much `packed_bytes` may become: little files that unpack to gigabytes are refused.
inline std::uint64_t most_unpacked_bytes(std::size_t packed_bytes) {
  constexpr std::uint64_t always = 256u << 20, per_byte = 100;
  return std::max(always, per_byte * packed_bytes);
}
/// For one that becomes more.
Error unpacks_to_more(std::size_t packed_bytes);

inline bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }
/// All of a gzip file, of which several may follow each other. Throws Error.
std::string decompress_gzip(std::string_view bytes);

/// Decompresses as much as is asked for, when it is asked for.
class Inflater {
 public:
  /// `bytes` begin with a zlib stream and outlive the inflater. Throws Error.
  explicit Inflater(std::string_view bytes);
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&stream_); }

  /// The next `size` bytes. Throws Error where the stream is corrupted, ends before, or is too
  /// long.
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
      check(count, before, sizeof(T));
      values.resize(before + std::min(count - before, std::max(before, step)));
      read(values.data() + before, (values.size() - before) * sizeof(T));
    }
    return values;
  }

 private:
  /// Before an array of `size` values grows towards `count`. Throws Error.
  void check(std::uint64_t count, std::uint64_t size, std::size_t value_bytes) const;

  z_stream stream_{};
  std::uint64_t left_ = 0;  ///< bytes that may still come
  std::size_t packed_bytes_ = 0;
};

}  // namespace pt
