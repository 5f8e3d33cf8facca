#include "common/scene/load/gltf/document/elements.h"

#include <algorithm>

namespace pt::gltf {

std::size_t component_size(const File& file, int component_type, const std::string& place) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      file.fail(place, fmt::format("componentType {}: expected 5120 to 5123, 5125 or 5126",
                                   component_type));
  }
}

Elements locate(const File& file, int view_index, std::size_t byte_offset, std::size_t count,
                int component_type, int components, const std::string& place) {
  const auto& view = file.at(file.model.bufferViews, view_index, "bufferViews", place);
  const auto& buffer = file.at(file.model.buffers, view.buffer, "buffers", place);
  const std::size_t size =
      component_size(file, component_type, place) * static_cast<std::size_t>(components);
  const std::size_t stride = view.byteStride == 0 ? size : view.byteStride;
  if (stride < size) {
    file.fail(place, fmt::format("byteStride {} of bufferViews[{}] is less than an element's {} "
                                 "bytes",
                                 stride, view_index, size));
  }
  const std::size_t end = view.byteOffset > buffer.data.size()
                              ? 0
                              : std::min(view.byteLength, buffer.data.size() - view.byteOffset);
  // byte_offset + (count - 1) * stride + size <= end, without overflow
  const bool fits = count == 0 || (size <= end && byte_offset <= end - size &&
                                   (count - 1) <= (end - size - byte_offset) / stride);
  if (!fits) {
    file.fail(place, fmt::format("{} elements of {} bytes from byte {} on exceed the {} bytes of "
                                 "bufferViews[{}]",
                                 count, size, byte_offset, end, view_index));
  }
  return {buffer.data.data() + view.byteOffset + byte_offset, count, stride, component_type,
          components};
}

}  // namespace pt::gltf
