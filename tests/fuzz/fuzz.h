// What the fuzz targets share: libFuzzer calls LLVMFuzzerTestOneInput with one input after the
// other and keeps those that reach new code.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "common/error/error.h"
#include "common/geometry/mesh.h"

namespace pt {

inline std::string_view as_bytes(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Runs `action`, which may throw Error with a message of one line and nothing else.
template <class Action>
void expect_result_or_error(Action action) {
  try {
    action();
  } catch (const Error& error) {
    if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
  }
}

/// Aborts where a mesh is not as geometry/mesh.h says.
inline void check_mesh(const Mesh& mesh) {
  const std::size_t count = mesh.positions.size();
  if (!mesh.normals.empty() && mesh.normals.size() != count) std::abort();
  if (!mesh.uvs.empty() && mesh.uvs.size() != count) std::abort();
  for (const TriangleIndices& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle.v) {
      if (v >= count) std::abort();
    }
  }
  for (const Vec3& p : mesh.positions) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) std::abort();
  }
  for (const Vec3& n : mesh.normals) {
    if (!(std::abs(glm::length(n) - 1.0f) < 1e-4f)) std::abort();
  }
  for (const Vec2& uv : mesh.uvs) {
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) std::abort();
  }
}

}  // namespace pt
