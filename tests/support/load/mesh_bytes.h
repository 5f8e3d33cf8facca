// Files of meshes and images byte by byte, for tests that read them.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace pt {

/// Appends values as a binary file stores them.
class MeshBytes {
 public:
  explicit MeshBytes(bool big_endian = false) : big_endian_(big_endian) {}

  template <class T>
  MeshBytes& put(T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      text += bytes[big_endian_ ? sizeof(T) - 1 - i : i];
    }
    return *this;
  }

  std::string text;

 private:
  bool big_endian_;
};

using Bytes = std::vector<int>;

inline MeshBytes& put_bytes(MeshBytes& out, const Bytes& bytes) {
  for (const int b : bytes) out.put(static_cast<std::uint8_t>(b));
  return out;
}

}  // namespace pt
