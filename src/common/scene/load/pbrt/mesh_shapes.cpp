// Shapes of triangles and of bilinear patches.
#include <fmt/format.h>

#include "common/error/host_memory.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/pbrt/scene_parts.h"
#include "common/scene/load/pbrt/syntax/tokens.h"

namespace pt::pbrt {
namespace {

/// What is not of each vertex is dropped.
template <class T>
std::vector<T> of_each_vertex(Context& context, const Parameters& parameters, const char* name,
                              std::vector<T> values, std::size_t vertices) {
  if (values.empty() || values.size() == vertices) return values;
  context.reporter.warn_once(fmt::format("count of {}", name), parameters.place(),
                             "{} values in '{}' of {}: ignored; expected {}, as of 'P'",
                             values.size(), name, parameters.what(), vertices);
  return {};
}

/// Indices in groups of this size; without any, one group of the vertices in their order.
std::vector<int> read_indices(Context& context, const Parameters& parameters, std::size_t size,
                              std::size_t vertices) {
  std::vector<int> indices = parameters.integers("indices");
  if (indices.empty()) {
    if (vertices != size) {
      fail(parameters.place(), "{} has no 'integer indices'", parameters.what());
    }
    for (std::size_t i = 0; i < size; ++i) indices.push_back(static_cast<int>(i));
  }
  for (const int index : indices) {
    if (index < 0 || static_cast<std::size_t>(index) >= vertices) {
      fail(parameters.place(), "{}: the index {}; expected 0 to {}, for there are {} points in 'P'",
           parameters.what(), index, std::int64_t(vertices) - 1, vertices);
    }
  }
  if (indices.size() % size != 0) {
    context.reporter.warn_once("indices " + parameters.what(), parameters.place(),
                               "{} indices: the last {} are left out; expected a multiple of {}",
                               indices.size(), indices.size() % size, size);
    indices.resize(indices.size() - indices.size() % size);
  }
  return indices;
}

/// Positions, and normals and texture coordinates where they are given.
Mesh read_vertices(Context& context, const Parameters& parameters) {
  Mesh mesh;
  mesh.positions = parameters.points("P");
  if (mesh.positions.empty()) {
    fail(parameters.place(), "{} has no 'point3 P'", parameters.what());
  }
  const std::size_t count = mesh.positions.size();
  mesh.normals = of_each_vertex(context, parameters, "N", parameters.points("N"), count);
  const char* uv = parameters.find("uv") || !parameters.find("st") ? "uv" : "st";
  mesh.uvs = of_each_vertex(context, parameters, uv, parameters.points2(uv), count);
  parameters.ignore({"S", "faceIndices", "shadowalpha", "discarddegenerateUVs"});
  return mesh;
}

/// As mesh_files.h promises; an Error has the place of the shape.
void finish(const Entity& entity, Mesh& mesh) {
  try {
    finish_mesh(mesh, {});
  } catch (const Error& error) {
    fail(entity.parameters.place(), "{}: {}", entity.parameters.what(), error.what());
  }
}

void set_triangles(Mesh& mesh, const std::vector<int>& indices) {
  mesh.triangles.reserve(indices.size() / 3);
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const auto at = [&](std::size_t k) { return static_cast<std::uint32_t>(indices[i + k]); };
    mesh.triangles.push_back({{at(0), at(1), at(2)}});
  }
}

}  // namespace

Mesh read_triangle_mesh(Context& context, const Entity& entity, const ShapeMaterial&) {
  Mesh mesh = read_vertices(context, entity.parameters);
  set_triangles(mesh, read_indices(context, entity.parameters, 3, mesh.positions.size()));
  finish(entity, mesh);
  return mesh;
}

/// Faces of four vertices, which pbrt makes bilinear patches, are two triangles.
Mesh read_ply_mesh(Context& context, const Entity& entity, const ShapeMaterial&) {
  const Parameters& parameters = entity.parameters;
  const Parameter* filename = parameters.find("filename", {"string"});
  if (!filename) fail(parameters.place(), "plymesh has no 'string filename'");
  if (parameters.find("displacement")) {
    context.reporter.warn_once("displacement of plymesh", parameters.place(),
                               "'displacement' of plymesh is not supported and ignored");
  }
  parameters.ignore({"edgelength", "shadowalpha", "discarddegenerateUVs"});  // the latter of v3
  const auto path = context.resolve(filename->place, parameters.text("filename", ""));
  std::vector<std::string> warnings;
  Mesh mesh;
  try {
    mesh = read_mesh({MeshFile::Format::ply, path}, warnings);
  } catch (const Error& error) {
    fail(filename->place, error.what());
  }
  for (const std::string& warning : warnings) {
    context.reporter.warn_once(warning, filename->place, "{}: {}", path.string(), warning);
  }
  mesh.colors.clear(), mesh.face_colors.clear();
  return mesh;
}

Mesh read_loop_mesh(Context& context, const Entity& entity, const ShapeMaterial&) {
  const Parameters& parameters = entity.parameters;
  Mesh cage;
  cage.positions = parameters.points("P");
  set_triangles(cage, read_indices(context, parameters, 3, cage.positions.size()));
  finish(entity, cage);
  parameters.ignore({"scheme"});
  const int levels = parameters.integer("levels", parameters.integer("nlevels", 3));  // of v3
  constexpr std::uint64_t most = 1u << 26;                                            // triangles
  if (levels < 0 || levels > 12 || (cage.triangles.size() << (2 * levels)) > most) {
    fail(parameters.place(),
         "loopsubdiv: {} levels of {} triangles; expected 0 to 12 and at most {} triangles in the "
         "end",
         levels, cage.triangles.size(), most);
  }
  try {
    // For each final triangle: its vertices, and the entries of its edges.
    constexpr std::uint64_t bytes = 256;
    check_host_memory((cage.triangles.size() << (2 * levels)) * bytes, "loopsubdiv");
    return subdivide_loop(cage, levels);
  } catch (const Error& error) {
    fail(parameters.place(), error.what());
  }
}

namespace {

// Bilinear patches.

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
