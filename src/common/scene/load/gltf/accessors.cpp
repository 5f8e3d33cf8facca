// Arrays of numbers in buffers.
#include <algorithm>

#include "common/error/host_memory.h"
#include "common/scene/load/gltf/document.h"
#include "common/scene/load/gltf/read_model.h"

namespace pt::gltf {
namespace {

/// The most zeros that accessors without a buffer view may have in all.
constexpr std::size_t max_zeros = std::size_t{1} << 24;

/// (specification, section 3.6.2.2 and, for the division, KHR_mesh_quantization)
float to_float(const Elements& elements, std::size_t element, int i, bool normalized) {
  const auto scaled = [&](float value, float largest) {
    return normalized ? std::max(value / largest, -1.0f) : value;
  };
  switch (elements.component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return scaled(elements.component<std::int8_t>(element, i), 127.0f);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return scaled(elements.component<std::uint8_t>(element, i), 255.0f);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return scaled(elements.component<std::int16_t>(element, i), 32767.0f);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return scaled(elements.component<std::uint16_t>(element, i), 65535.0f);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return scaled(static_cast<float>(elements.component<std::uint32_t>(element, i)),
                    4294967295.0f);
    default:
      return elements.component<float>(element, i);
  }
}

std::uint32_t to_index(const Elements& elements, std::size_t element) {
  switch (elements.component_type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return elements.component<std::uint8_t>(element, 0);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return elements.component<std::uint16_t>(element, 0);
    default:
      return elements.component<std::uint32_t>(element, 0);
  }
}

void check_index_type(const File& file, int component_type, const std::string& place) {
  if (component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
      component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
    file.fail(place, "componentType {}: expected indices of type 5121, 5123 or 5125",
              component_type);
  }
}

std::string accessor_place(int accessor, const std::string& place) {
  return fmt::format("{} = accessors[{}]", place, accessor);
}

const tinygltf::Accessor& checked_accessor(const File& file, int index, int components,
                                           const std::string& place) {
  const auto& accessor = file.at(file.model.accessors, index, "accessors", place);
  const bool is_vector = accessor.type >= TINYGLTF_TYPE_VEC2 && accessor.type <= TINYGLTF_TYPE_VEC4;
  const int actual = accessor.type == TINYGLTF_TYPE_SCALAR ? 1
                     : accessor.type == TINYGLTF_TYPE_MAT4 ? 16
                                                           : (is_vector ? accessor.type : 0);
  if (actual != components) {
    const std::string expected = components == 1    ? "SCALAR"
                                 : components == 16 ? "MAT4"
                                                    : fmt::format("VEC{}", components);
    file.fail(place, "another type, expected " + expected);
  }
  return accessor;
}

Elements dense_elements(const File& file, const tinygltf::Accessor& accessor, int components,
                        const std::string& place) {
  if (accessor.bufferView >= 0) {
    return locate(file, accessor.bufferView, accessor.byteOffset, accessor.count,
                  accessor.componentType, components, place);
  }
  if (accessor.count > max_zeros - file.zeros) {
    file.fail(place, "{} elements without a bufferView: expected at most {} in a file",
              accessor.count, max_zeros);
  }
  file.zeros += accessor.count;
  component_size(file, accessor.componentType, place);
  return {nullptr, accessor.count, 0, accessor.componentType, components};
}

/// Several primitives may name one accessor, so that a small file asks for much memory. `bytes`: of
/// each element, with what meshes are made of it.
void check_memory(const Elements& elements, std::size_t bytes, const std::string& place) {
  constexpr std::size_t small = std::size_t{1} << 20;
  const std::size_t all = elements.count * bytes;
  if (all > small) check_host_memory(all, place);
}

/// Calls replace(element, values, i) for each element `element` that the sparse part replaces by
/// number i of `values`.
template <class Function>
void for_each_replacement(const File& file, const tinygltf::Accessor& accessor, int components,
                          const std::string& place, Function&& replace) {
  if (!accessor.sparse.isSparse) return;
  const auto& sparse = accessor.sparse;
  const std::string sparse_place = place + ".sparse";
  if (sparse.count < 0 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0) {
    file.fail(sparse_place, "expected numbers that are not negative");
  }
  check_index_type(file, sparse.indices.componentType, sparse_place + ".indices");
  const auto count = static_cast<std::size_t>(sparse.count);
  const Elements indices =
      locate(file, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset),
             count, sparse.indices.componentType, 1, sparse_place + ".indices");
  const Elements values =
      locate(file, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset),
             count, accessor.componentType, components, sparse_place + ".values");
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t element = to_index(indices, i);
    if (element >= accessor.count) {
      file.fail(sparse_place + ".indices", "entry {} is {}, there are {} elements", i, element,
                accessor.count);
    }
    replace(element, values, i);
  }
}

}  // namespace

std::vector<float> read_floats(const File& file, int index, int components,
                               const std::string& outer_place) {
  const std::string place = accessor_place(index, outer_place);
  const auto& accessor = checked_accessor(file, index, components, place);
  const Elements elements = dense_elements(file, accessor, components, place);
  const auto width = static_cast<std::size_t>(components);
  check_memory(elements, 2 * width * sizeof(float), place);
  std::vector<float> result(elements.count * width, 0.0f);
  const auto copy = [&](std::size_t to, const Elements& from, std::size_t element) {
    for (int i = 0; i < components; ++i) {
      result[to * width + static_cast<std::size_t>(i)] =
          to_float(from, element, i, accessor.normalized);
    }
  };
  if (elements.first) {
    for (std::size_t i = 0; i < elements.count; ++i) copy(i, elements, i);
  }
  for_each_replacement(file, accessor, components, place, copy);
  return result;
}

std::vector<std::uint32_t> read_indices(const File& file, int index,
                                        const std::string& outer_place) {
  const std::string place = accessor_place(index, outer_place);
  const auto& accessor = checked_accessor(file, index, 1, place);
  check_index_type(file, accessor.componentType, place);
  const Elements elements = dense_elements(file, accessor, 1, place);
  check_memory(elements, 2 * sizeof(std::uint32_t), place);
  std::vector<std::uint32_t> result(elements.count, 0);
  if (elements.first) {
    for (std::size_t i = 0; i < elements.count; ++i) result[i] = to_index(elements, i);
  }
  for_each_replacement(file, accessor, 1, place,
                       [&](std::size_t to, const Elements& from, std::size_t element) {
                         result[to] = to_index(from, element);
                       });
  return result;
}

}  // namespace pt::gltf
