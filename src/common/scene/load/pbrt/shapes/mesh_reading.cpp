#include "common/scene/load/pbrt/shapes/mesh_reading.h"

#include <fmt/format.h>

#include "common/scene/load/files/meshes/mesh_finish.h"

namespace pt::pbrt {
namespace {

/// What is not of each vertex is dropped.
template <class T>
std::vector<T> of_each_vertex(Context& context, const Parameters& parameters, const char* name,
                              std::vector<T> values, std::size_t vertices) {
  if (values.empty() || values.size() == vertices) return values;
  context.reporter.warn_once(fmt::format("count of {}", name), parameters.place(),
                             fmt::format("{} values in '{}' of {}: ignored; expected {}, as of 'P'",
                                         values.size(), name, parameters.what(), vertices));
  return {};
}

}  // namespace

std::vector<int> read_indices(Context& context, const Parameters& parameters, std::size_t size,
                              std::size_t vertices) {
  std::vector<int> indices = parameters.integers("indices");
  if (indices.empty()) {
    if (vertices != size) {
      fail(parameters.place(), fmt::format("{} has no 'integer indices'", parameters.what()));
    }
    for (std::size_t i = 0; i < size; ++i) indices.push_back(static_cast<int>(i));
  }
  for (const int index : indices) {
    if (index < 0 || static_cast<std::size_t>(index) >= vertices) {
      fail(parameters.place(),
           fmt::format("{}: the index {}; expected 0 to {}, for there are {} "
                       "points in 'P'",
                       parameters.what(), index, std::int64_t(vertices) - 1, vertices));
    }
  }
  if (indices.size() % size != 0) {
    context.reporter.warn_once("indices " + parameters.what(), parameters.place(),
                               fmt::format("{} indices: the last {} are left out; expected a "
                                           "multiple of {}",
                                           indices.size(), indices.size() % size, size));
    indices.resize(indices.size() - indices.size() % size);
  }
  return indices;
}

Mesh read_vertices(Context& context, const Parameters& parameters) {
  Mesh mesh;
  mesh.positions = parameters.points("P");
  if (mesh.positions.empty()) {
    fail(parameters.place(), fmt::format("{} has no 'point3 P'", parameters.what()));
  }
  const std::size_t count = mesh.positions.size();
  mesh.normals = of_each_vertex(context, parameters, "N", parameters.points("N"), count);
  const char* uv = parameters.find("uv") || !parameters.find("st") ? "uv" : "st";
  mesh.uvs = of_each_vertex(context, parameters, uv, parameters.points2(uv), count);
  parameters.ignore({"S", "faceIndices", "shadowalpha", "discarddegenerateUVs"});
  return mesh;
}

void finish(const Entity& entity, Mesh& mesh) {
  try {
    finish_mesh(mesh, {});
  } catch (const Error& error) {
    fail(entity.parameters.place(), fmt::format("{}: {}", entity.parameters.what(), error.what()));
  }
}

}  // namespace pt::pbrt
