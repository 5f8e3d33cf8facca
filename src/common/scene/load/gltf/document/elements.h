// Elements of an accessor where they lie: in a part of a buffer.
#pragma once

#include <cstddef>
#include <cstring>

#include "common/scene/load/gltf/document/file.h"

namespace pt::gltf {

/// Strided elements, checked to lie within their buffer.
struct Elements {
  const unsigned char* first = nullptr;  ///< null: all zeros
  std::size_t count = 0, stride = 0;
  int component_type = 0;
  int components = 1;

  template <class T>
  T component(std::size_t element, int i) const {
    T value;
    std::memcpy(&value, first + element * stride + static_cast<std::size_t>(i) * sizeof(T),
                sizeof value);
    return value;
  }
};

/// Bytes of a component; an Error at `place` for types that glTF 2.0 does not have.
std::size_t component_size(const File& file, int component_type, const std::string& place);

/// `count` elements from `byte_offset` of a buffer view on. An Error at `place` where they exceed
/// it.
Elements locate(const File& file, int view_index, std::size_t byte_offset, std::size_t count,
                int component_type, int components, const std::string& place);

}  // namespace pt::gltf
