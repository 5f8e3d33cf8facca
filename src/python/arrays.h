// Arrays from and to Python.
#pragma once

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstring>
#include <initializer_list>
#include <vector>

#include "common/error/error.h"
#include "common/geometry/mesh.h"

namespace pt::python {

using FloatsIn =
    nanobind::ndarray<const float, nanobind::ndim<2>, nanobind::c_contig, nanobind::device::cpu>;
using IndicesIn = nanobind::ndarray<const std::uint32_t, nanobind::ndim<2>, nanobind::c_contig,
                                    nanobind::device::cpu>;

/// A Python array that owns the values.
template <class T>
nanobind::object array_of(std::vector<T>&& values, std::initializer_list<std::size_t> shape) {
  auto* const owned = new std::vector<T>(std::move(values));
  const nanobind::capsule owner(owned,
                                [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  using Array = nanobind::ndarray<nanobind::array_api, T, nanobind::device::cpu>;
  return nanobind::cast(Array(owned->data(), shape, owner));
}

/// The rows of an array of `columns` columns as values of type T.
template <class T, class Array>
std::vector<T> rows_of(const Array& array, std::size_t columns, const char* name) {
  static_assert(sizeof(T) % 4 == 0);
  if (array.shape(1) != columns)
    throw Error(fmt::format("{}: {} columns; expected {}", name, array.shape(1), columns));
  std::vector<T> values(array.shape(0));
  if (!values.empty()) std::memcpy(values.data(), array.data(), values.size() * sizeof(T));
  return values;
}

inline Mesh mesh_of(const FloatsIn& vertices, const IndicesIn& triangles) {
  Mesh mesh;
  mesh.positions = rows_of<Vec3>(vertices, 3, "vertices");
  mesh.triangles = rows_of<TriangleIndices>(triangles, 3, "triangles");
  return mesh;
}

}  // namespace pt::python
