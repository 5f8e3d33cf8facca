// Values as bytes, little-endian whatever the machine, for messages between processes.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "common/error/error.h"

namespace pt {

/// Numbers of 4 or 8 bytes, or structures that consist of such of 8 alone.
template <class T, std::size_t word = sizeof(T) == 4 ? 4 : 8>
void to_little_endian(T* values, std::size_t count) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % word == 0);
  if constexpr (std::endian::native == std::endian::big) {
    auto* bytes = reinterpret_cast<char*>(values);
    for (std::size_t i = 0; i < count * sizeof(T); i += word) {
      std::reverse(bytes + i, bytes + i + word);
    }
  }
}

class ByteWriter {
 public:
  template <class T>
  void array(const std::vector<T>& values) {
    number(std::uint64_t{values.size()});
    raw(values.data(), values.size());
  }
  template <class T>
  void number(T value) {
    static_assert(std::is_arithmetic_v<T> && (sizeof(T) == 4 || sizeof(T) == 8));
    raw(&value, 1);
  }
  void text(std::string_view value) {
    number(std::uint64_t{value.size()});
    bytes_.append(value);
  }
  /// How many follow, then each of them as `write` does.
  template <class List, class Write>
  void list(const List& values, Write&& write) {
    number(std::uint64_t{values.size()});
    for (const auto& value : values) write(value);
  }
  template <class T>
  void raw(const T* values, std::size_t count) {
    if (count == 0) return;
    const std::size_t begin = bytes_.size();
    bytes_.append(reinterpret_cast<const char*>(values), count * sizeof(T));
    to_little_endian(reinterpret_cast<T*>(bytes_.data() + begin), count);
  }

  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Throws Error where the bytes end before the value does.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  template <class T>
  T number() {
    T value{};
    raw(&value, 1);
    return value;
  }
  std::string text() {
    const std::size_t size = count_of(1);
    std::string value(rest_.substr(0, size));
    rest_.remove_prefix(size);
    return value;
  }
  template <class T>
  std::vector<T> array() {
    std::vector<T> values(count_of(sizeof(T)));
    raw(values.data(), values.size());
    return values;
  }
  /// A list of values that take a byte or more each, as `read` reads them.
  template <class Read>
  auto list(Read&& read) {
    std::vector<decltype(read())> values;
    for (std::size_t count = count_of(1); count > 0; --count) values.push_back(read());
    return values;
  }
  template <class T>
  void raw(T* values, std::size_t count) {
    if (count > rest_.size() / sizeof(T)) throw Error("a message that is cut off");
    if (count == 0) return;
    std::memcpy(values, rest_.data(), count * sizeof(T));
    to_little_endian(values, count);
    rest_.remove_prefix(count * sizeof(T));
  }

  /// What is not yet read.
  std::string_view rest() const { return rest_; }
  void expect_end() const {
    if (!rest_.empty()) throw Error("a message that is longer than expected");
  }

 private:
  /// Before memory is taken for them.
  std::size_t count_of(std::size_t size_bytes) {
    const auto count = number<std::uint64_t>();
    if (count > rest_.size() / size_bytes) throw Error("a message that is cut off");
    return count;
  }

  std::string_view rest_;
};

}  // namespace pt
