// The values in the body of a PLY file, one after the other.
#pragma once

#include <cstring>
#include <string_view>
#include <type_traits>

#include "common/error/error.h"
#include "common/scene/load/files/meshes/ply_header.h"

namespace pt {

/// The bytes of one value in the other order.
template <class T>
T swap_bytes(T value) {
  unsigned char bytes[sizeof(T)], swapped[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  for (std::size_t i = 0; i < sizeof(T); ++i) swapped[i] = bytes[sizeof(T) - 1 - i];
  std::memcpy(&value, swapped, sizeof(T));
  return value;
}

/// The value at `from`, which need not be aligned; `big_endian` says how it is stored there, on
/// a little-endian machine.
template <class T>
T load_value(const char* from, bool big_endian) {
  T value;
  std::memcpy(&value, from, sizeof(T));
  return big_endian ? swap_bytes(value) : value;
}

/// Calls function(T{}) with the C++ type of `type`.
template <class Function>
decltype(auto) visit_type(PlyType type, Function&& function) {
  switch (type) {
    case PlyType::int8:
      return function(std::int8_t{});
    case PlyType::uint8:
      return function(std::uint8_t{});
    case PlyType::int16:
      return function(std::int16_t{});
    case PlyType::uint16:
      return function(std::uint16_t{});
    case PlyType::int32:
      return function(std::int32_t{});
    case PlyType::uint32:
      return function(std::uint32_t{});
    case PlyType::float32:
      return function(float{});
    default:
      return function(double{});
  }
}

/// Binary values. Doubles hold every type exactly.
class PlyBinaryValues {
 public:
  PlyBinaryValues(std::string_view body, bool big_endian) : rest_(body), big_endian_(big_endian) {}

  /// Throws Error at the end of the file.
  double next(PlyType type) {
    const char* from = take(size_bytes(type));
    return visit_type(type, [&](auto kind) {
      return static_cast<double>(load_value<decltype(kind)>(from, big_endian_));
    });
  }

  /// Passes over so many bytes and returns where they begin.
  const char* take(std::size_t bytes) {
    if (rest_.size() < bytes) throw Error("the file ends here");
    const char* begin = rest_.data();
    rest_.remove_prefix(bytes);
    return begin;
  }

  std::string_view rest() const { return rest_; }
  bool big_endian() const { return big_endian_; }

 private:
  std::string_view rest_;
  bool big_endian_;
};

/// Numbers in text, apart by white space.
class PlyTextValues {
 public:
  explicit PlyTextValues(std::string_view body) : rest_(body) {}

  /// Throws Error at the end of the file and for what is no number.
  double next(PlyType type);

  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

}  // namespace pt
