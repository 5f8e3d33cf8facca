// Bilinear patches.
#include <fmt/format.h>

#include "common/scene/load/pbrt/shapes/mesh_reading.h"
#include "common/scene/load/pbrt/shapes/tessellate.h"

namespace pt::pbrt {
namespace {

/// Its corners, those with u = 0 and v = 0 first, then u = 1, then v = 1.
struct Patch {
  Vec3 p[4];

  Vec3 position(float u, float v) const {
    return (1.0f - v) * ((1.0f - u) * p[0] + u * p[1]) + v * ((1.0f - u) * p[2] + u * p[3]);
  }
  Vec3 normal(float u, float v) const {
    const Vec3 du = (1.0f - v) * (p[1] - p[0]) + v * (p[3] - p[2]);
    const Vec3 dv = (1.0f - u) * (p[2] - p[0]) + u * (p[3] - p[1]);
    const Vec3 n = glm::cross(du, dv);
    const float length = glm::length(n);
    return length > 0.0f ? n / length : Vec3(0, 0, 1);
  }
  /// Two triangles are all of it, and linear in (u, v).
  bool is_parallelogram() const {
    const float size = glm::length(p[3] - p[0]) + glm::length(p[2] - p[1]);
    return glm::length(p[0] + p[3] - p[1] - p[2]) <= 1e-6f * size;
  }
};

template <class T>
T interpolated(const std::vector<T>& values, const int* corners, const Vec2& at) {
  const float u = at.x, v = at.y;
  const auto of = [&](int i) { return values[static_cast<std::size_t>(corners[i])]; };
  return (1.0f - v) * ((1.0f - u) * of(0) + u * of(1)) + v * ((1.0f - u) * of(2) + u * of(3));
}

void add_patch(const Mesh& vertices, const int* corners, Mesh& mesh) {
  Patch patch;
  for (int i = 0; i < 4; ++i) {
    patch.p[i] = vertices.positions[static_cast<std::size_t>(corners[i])];
  }
  const int cells = patch.is_parallelogram() ? 1 : patch_cells;
  const std::size_t first = mesh.positions.size();
  tessellate(mesh, cells, cells, [&](float u, float v) {
    return SurfacePoint{patch.position(u, v), patch.normal(u, v)};
  });
  for (std::size_t i = first; i < mesh.positions.size(); ++i) {
    const Vec2 at = mesh.uvs[i];
    if (!vertices.normals.empty()) {
      const Vec3 normal = interpolated(vertices.normals, corners, at);
      if (glm::length(normal) > 0.0f) mesh.normals[i] = glm::normalize(normal);
    }
    if (!vertices.uvs.empty()) mesh.uvs[i] = interpolated(vertices.uvs, corners, at);
  }
}

}  // namespace

Mesh read_bilinear_mesh(Context& context, const Entity& entity, const ShapeMaterial&) {
  const Parameters& parameters = entity.parameters;
  Mesh vertices = read_vertices(context, parameters), mesh;
  const std::vector<int> indices = read_indices(context, parameters, 4, vertices.positions.size());
  finish(entity, vertices);
  if (parameters.find("emissionfilename")) {
    context.reporter.warn_once("emissionfilename", parameters.place(),
                               "'emissionfilename' of bilinearmesh is not supported and ignored");
  }
  for (std::size_t i = 0; i + 3 < indices.size(); i += 4) add_patch(vertices, &indices[i], mesh);
  return mesh;
}

}  // namespace pt::pbrt
