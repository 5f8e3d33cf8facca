#include "common/scene/load/gltf/meshes.h"

#include <algorithm>
#include <numeric>

#include "common/scene/load/gltf/document/accessors.h"

namespace pt::gltf {

namespace {

std::vector<Vec3> read_vec3s(const File& file, int accessor, const std::string& place) {
  const std::vector<float> values = read_floats(file, accessor, 3, place);
  std::vector<Vec3> result(values.size() / 3);
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  }
  return result;
}

bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void read_positions(const File& file, int accessor, const std::string& place, Mesh& mesh) {
  mesh.positions = read_vec3s(file, accessor, place);
  const auto bad = std::find_if_not(mesh.positions.begin(), mesh.positions.end(), is_finite);
  if (bad != mesh.positions.end()) {
    file.fail(place, fmt::format("vertex {} is not finite", bad - mesh.positions.begin()));
  }
}

void check_count(const File& file, std::size_t count, const Mesh& mesh, const std::string& place) {
  if (count != mesh.positions.size()) {
    file.fail(place, fmt::format("{} elements, but POSITION has {}", count, mesh.positions.size()));
  }
}

void read_normals(File& file, int accessor, const std::string& place, Mesh& mesh) {
  mesh.normals = read_vec3s(file, accessor, place);
  check_count(file, mesh.normals.size(), mesh, place);
  for (Vec3& n : mesh.normals) {
    const float length = glm::length(n);
    if (!(length > 0.0f) || !std::isfinite(length)) {
      file.report(place, "normals without a direction: the mesh is flat instead");
      mesh.normals.clear();
      return;
    }
    n /= length;
  }
}

/// glTF's v goes down from the image's head, Mesh's goes up from its foot.
void read_uvs(const File& file, int accessor, const std::string& place, Mesh& mesh) {
  const std::vector<float> values = read_floats(file, accessor, 2, place);
  check_count(file, values.size() / 2, mesh, place);
  mesh.uvs.resize(values.size() / 2);
  for (std::size_t i = 0; i < mesh.uvs.size(); ++i) {
    const float u = values[2 * i], v = values[2 * i + 1];
    mesh.uvs[i] = {std::isfinite(u) ? u : 0.0f, std::isfinite(v) ? 1.0f - v : 0.0f};
  }
}

/// RGB or RGBA, linear.
void read_colors(File& file, int accessor, const std::string& place, Mesh& mesh) {
  const auto& source = file.at(file.model.accessors, accessor, "accessors", place);
  const int components = source.type == TINYGLTF_TYPE_VEC4 ? 4 : 3;
  const std::vector<float> values = read_floats(file, accessor, components, place);
  const auto width = static_cast<std::size_t>(components);
  check_count(file, values.size() / width, mesh, place);
  mesh.colors.resize(values.size() / width);
  const auto clamp = [](float x) { return x > 0.0f ? std::min(x, 1.0f) : 0.0f; };
  bool opaque = true;
  for (std::size_t i = 0; i < mesh.colors.size(); ++i) {
    const float* rgba = &values[i * width];
    mesh.colors[i] = {clamp(rgba[0]), clamp(rgba[1]), clamp(rgba[2])};
    opaque = opaque && (components == 3 || rgba[3] >= 1.0f);
  }
  if (!opaque) file.report(place, "the alpha of vertices is ignored");
}

std::vector<std::uint32_t> vertex_sequence(const File& file, const tinygltf::Primitive& primitive,
                                           const Mesh& mesh, const std::string& place) {
  if (primitive.indices < 0) {
    std::vector<std::uint32_t> sequence(mesh.positions.size());
    std::iota(sequence.begin(), sequence.end(), 0u);
    return sequence;
  }
  const std::string indices_place = place + ".indices";
  std::vector<std::uint32_t> sequence = read_indices(file, primitive.indices, indices_place);
  for (std::size_t i = 0; i < sequence.size(); ++i) {
    if (sequence[i] >= mesh.positions.size()) {
      file.fail(indices_place, fmt::format("entry {} is {}, there are {} vertices", i, sequence[i],
                                           mesh.positions.size()));
    }
  }
  return sequence;
}

/// (specification, section 3.7.2.1)
std::vector<TriangleIndices> make_triangles(const File& file, int mode,
                                            const std::vector<std::uint32_t>& v,
                                            const std::string& place) {
  std::vector<TriangleIndices> triangles;
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    if (v.size() % 3 != 0) {
      file.fail(place, fmt::format("{} vertices: expected three for each triangle", v.size()));
    }
    for (std::size_t i = 0; i < v.size(); i += 3) {
      triangles.push_back({{v[i], v[i + 1], v[i + 2]}});
    }
    return triangles;
  }
  for (std::size_t i = 0; i + 2 < v.size(); ++i) {
    if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
      triangles.push_back({{v[i + 1], v[i + 2], v[0]}});
    } else {
      const std::size_t odd = i % 2;
      triangles.push_back({{v[i], v[i + 1 + odd], v[i + 2 - odd]}});
    }
  }
  return triangles;
}

void report_ignored(File& file, const tinygltf::Primitive& primitive, const std::string& place) {
  if (!primitive.targets.empty()) file.report(place, "morph targets are ignored");
}

Mesh read_primitive(File& file, const tinygltf::Primitive& primitive, const std::string& place) {
  const auto place_of = [&](const char* name) { return place + ".attributes." + name; };
  Mesh mesh;
  const auto& attributes = primitive.attributes;
  const auto positions = attributes.find("POSITION");
  if (positions == attributes.end()) {
    file.report(place, "a primitive without POSITION is ignored");
    return mesh;
  }
  read_positions(file, positions->second, place_of("POSITION"), mesh);
  if (const auto normals = attributes.find("NORMAL"); normals != attributes.end()) {
    read_normals(file, normals->second, place_of("NORMAL"), mesh);
  }
  if (const auto uvs = attributes.find("TEXCOORD_0"); uvs != attributes.end()) {
    read_uvs(file, uvs->second, place_of("TEXCOORD_0"), mesh);
  }
  if (const auto colors = attributes.find("COLOR_0"); colors != attributes.end()) {
    read_colors(file, colors->second, place_of("COLOR_0"), mesh);
  }
  mesh.triangles =
      make_triangles(file, primitive.mode, vertex_sequence(file, primitive, mesh, place), place);
  report_ignored(file, primitive, place);
  return mesh;
}

}  // namespace

std::vector<PrimitiveMesh> read_primitives(File& file, int mesh) {
  std::vector<PrimitiveMesh> result;
  const auto& primitives = file.model.meshes[static_cast<std::size_t>(mesh)].primitives;
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const std::string place = fmt::format("meshes[{}].primitives[{}]", mesh, i);
    const int mode = primitives[i].mode;
    if (mode < TINYGLTF_MODE_POINTS || mode > TINYGLTF_MODE_TRIANGLE_FAN) {
      file.fail(place + ".mode", fmt::format("{}: expected 0 to 6", mode));
    }
    if (mode < TINYGLTF_MODE_TRIANGLES) {
      file.report(place, "points and lines are ignored");
      continue;
    }
    PrimitiveMesh read{read_primitive(file, primitives[i], place), primitives[i].material};
    if (!read.mesh.triangles.empty()) result.push_back(std::move(read));
  }
  return result;
}

}  // namespace pt::gltf
