#include "common/scene/load/gltf/meshes.h"

#include <algorithm>
#include <numeric>

#include "common/scene/load/gltf/document.h"

namespace pt::gltf {
namespace {

bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

std::string attribute_place(const std::string& place, const std::string& name) {
  return place + ".attributes." + name;
}

void check_count(const File& file, std::size_t count, const Mesh& mesh, const std::string& place) {
  if (count != mesh.positions.size()) {
    file.fail(place, "{} elements, but POSITION has {}", count, mesh.positions.size());
  }
}

/// What a primitive is made of, with the weights of its morph targets; those without one have 0.
struct Source {
  const tinygltf::Primitive& primitive;
  const std::vector<double>& weights;
  std::string place;
};

/// An attribute, moved by the morph targets.
std::vector<float> read_attribute(const File& file, const Source& source, const std::string& name,
                                  int components) {
  const auto& [primitive, weights, place] = source;
  std::vector<float> values =
      read_floats(file, primitive.attributes.at(name), components, attribute_place(place, name));
  for (std::size_t i = 0; i < primitive.targets.size() && i < weights.size(); ++i) {
    const auto found = primitive.targets[i].find(name);
    const auto weight = static_cast<float>(weights[i]);
    if (found == primitive.targets[i].end() || weight == 0.0f) continue;
    const std::string target_place = fmt::format("{}.targets[{}].{}", place, i, name);
    const std::vector<float> moves = read_floats(file, found->second, components, target_place);
    if (moves.size() != values.size()) {
      const auto width = static_cast<std::size_t>(components);
      file.fail(target_place, "{} elements, but {} has {}", moves.size() / width, name,
                values.size() / width);
    }
    for (std::size_t v = 0; v < values.size(); ++v) values[v] += weight * moves[v];
  }
  return values;
}

std::vector<Vec3> read_vec3s(const File& file, const Source& source, const std::string& name) {
  const std::vector<float> values = read_attribute(file, source, name, 3);
  std::vector<Vec3> result(values.size() / 3);
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  }
  return result;
}

void unitize_normals(File& file, const std::string& place, Mesh& mesh) {
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
std::vector<Vec2> read_uvs(const File& file, const Source& source, const std::string& name,
                           const Mesh& mesh) {
  const std::vector<float> values = read_attribute(file, source, name, 2);
  check_count(file, values.size() / 2, mesh, attribute_place(source.place, name));
  std::vector<Vec2> uvs(values.size() / 2);
  for (std::size_t i = 0; i < uvs.size(); ++i) {
    const float u = values[2 * i], v = values[2 * i + 1];
    uvs[i] = {std::isfinite(u) ? u : 0.0f, std::isfinite(v) ? 1.0f - v : 0.0f};
  }
  return uvs;
}

/// JOINTS_0, JOINTS_1, ... with their weights, whose sum becomes 1: exporters quantise them.
Influences read_influences(const File& file, const tinygltf::Primitive& primitive, const Mesh& mesh,
                           const std::string& place) {
  Influences result;
  const std::size_t vertices = mesh.positions.size();
  const auto& attributes = primitive.attributes;
  std::vector<std::vector<float>> joints, weights;
  for (int set = 0;; ++set) {
    const std::string names[2] = {fmt::format("JOINTS_{}", set), fmt::format("WEIGHTS_{}", set)};
    const auto joint = attributes.find(names[0]), weight = attributes.find(names[1]);
    if (joint == attributes.end() || weight == attributes.end()) break;
    joints.push_back(read_floats(file, joint->second, 4, attribute_place(place, names[0])));
    weights.push_back(read_floats(file, weight->second, 4, attribute_place(place, names[1])));
    check_count(file, joints.back().size() / 4, mesh, attribute_place(place, names[0]));
    check_count(file, weights.back().size() / 4, mesh, attribute_place(place, names[1]));
  }
  result.per_vertex = 4 * joints.size();
  for (std::size_t v = 0; v < vertices && !joints.empty(); ++v) {
    float sum = 0.0f;
    for (std::size_t set = 0; set < joints.size(); ++set) {
      for (std::size_t i = 4 * v; i < 4 * v + 4; ++i) {
        const float weight = weights[set][i] > 0.0f ? weights[set][i] : 0.0f;
        result.joints.push_back(static_cast<std::uint32_t>(joints[set][i]));
        result.weights.push_back(weight);
        sum += weight;
      }
    }
    float* first = &result.weights[v * result.per_vertex];
    if (sum > 0.0f && std::isfinite(sum)) {
      for (std::size_t i = 0; i < result.per_vertex; ++i) first[i] /= sum;
    } else {
      std::fill(first, first + result.per_vertex, 0.0f);
      first[0] = 1.0f;
    }
  }
  return result;
}

/// RGB or RGBA, linear.
void read_colors(File& file, const Source& source, Mesh& mesh) {
  const std::string name = "COLOR_0", place = attribute_place(source.place, name);
  const auto& accessor =
      file.at(file.model.accessors, source.primitive.attributes.at(name), "accessors", place);
  const int components = accessor.type == TINYGLTF_TYPE_VEC4 ? 4 : 3;
  const std::vector<float> values = read_attribute(file, source, name, components);
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
  if (primitive.indices >= 0) return read_indices(file, primitive.indices, place + ".indices");
  std::vector<std::uint32_t> sequence(mesh.positions.size());
  std::iota(sequence.begin(), sequence.end(), 0u);
  return sequence;
}

/// Leaves out triangles of vertices that do not exist or are nowhere.
void drop_bad_triangles(File& file, const std::string& place, Mesh& mesh) {
  std::vector<TriangleIndices> kept;
  kept.reserve(mesh.triangles.size());
  for (const TriangleIndices& triangle : mesh.triangles) {
    const auto beyond = std::ranges::find_if(
        triangle.v, [&](std::uint32_t v) { return v >= mesh.positions.size(); });
    if (beyond != std::end(triangle.v)) {
      file.report_value(place + ".indices", "index",
                        "index {}, there are {} vertices: its triangles are left out", *beyond,
                        mesh.positions.size());
      continue;
    }
    const auto bad = std::ranges::find_if(
        triangle.v, [&](std::uint32_t v) { return !is_finite(mesh.positions[v]); });
    if (bad != std::end(triangle.v)) {
      file.report_value(attribute_place(place, "POSITION"), "vertex",
                        "vertex {} is not finite: its triangles are left out", *bad);
      continue;
    }
    kept.push_back(triangle);
  }
  mesh.triangles = std::move(kept);
  if (mesh.triangles.empty()) return;
  const Vec3 used = mesh.positions[mesh.triangles[0].v[0]];
  for (Vec3& p : mesh.positions) {
    if (!is_finite(p)) p = used;  // of no triangle, but the mesh's bounds hold all
  }
}

/// (specification, section 3.7.2.1)
std::vector<TriangleIndices> make_triangles(File& file, int mode,
                                            const std::vector<std::uint32_t>& v,
                                            const std::string& place) {
  std::vector<TriangleIndices> triangles;
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    if (v.size() % 3 != 0) {
      file.report(place, "{} vertices: expected three for each triangle: the last are left out",
                  v.size());
    }
    for (std::size_t i = 0; i + 2 < v.size(); i += 3) {
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

/// A primitive without data of its own: in an extension that compresses it, or nowhere.
bool has_positions(File& file, const tinygltf::Primitive& primitive, const std::string& place) {
  const auto positions = primitive.attributes.find("POSITION");
  if (positions == primitive.attributes.end()) {
    file.report(place, "a primitive without POSITION is ignored");
    return false;
  }
  const auto& accessor = file.at(file.model.accessors, positions->second, "accessors",
                                 attribute_place(place, "POSITION"));
  if (accessor.bufferView >= 0 || accessor.sparse.isSparse) return true;
  const auto& extensions = primitive.extensions;
  file.report(
      attribute_place(place, "POSITION"),
      extensions.empty()
          ? "an accessor without a bufferView, all zeros: the primitive is ignored"
          : fmt::format("{:.80} is not supported: a primitive whose data is in it is left out",
                        extensions.begin()->first));
  return false;
}

void read_uv_sets(const File& file, const Source& source, PrimitiveMesh& result) {
  for (const auto& [name, accessor] : source.primitive.attributes) {
    constexpr std::string_view prefix = "TEXCOORD_";
    if (!name.starts_with(prefix) || name.size() != prefix.size() + 1) continue;
    const int set = name.back() - '0';
    if (set < 0 || set > 9) continue;
    result.uv_sets[set] = read_uvs(file, source, name, result.mesh);
  }
}

PrimitiveMesh read_primitive(File& file, const Source& source) {
  PrimitiveMesh result;
  const auto& [primitive, weights, place] = source;
  if (!has_positions(file, primitive, place)) return result;
  Mesh& mesh = result.mesh;
  mesh.positions = read_vec3s(file, source, "POSITION");
  if (primitive.attributes.contains("NORMAL")) {
    const std::string normals_place = attribute_place(place, "NORMAL");
    mesh.normals = read_vec3s(file, source, "NORMAL");
    check_count(file, mesh.normals.size(), mesh, normals_place);
    unitize_normals(file, normals_place, mesh);
  }
  read_uv_sets(file, source, result);
  if (primitive.attributes.contains("COLOR_0")) read_colors(file, source, mesh);
  result.influences = read_influences(file, primitive, mesh, place);
  mesh.triangles =
      make_triangles(file, primitive.mode, vertex_sequence(file, primitive, mesh, place), place);
  drop_bad_triangles(file, place, mesh);
  return result;
}

}  // namespace

std::vector<PrimitiveMesh> read_primitives(File& file, int mesh,
                                           const std::vector<double>& weights) {
  std::vector<PrimitiveMesh> result;
  const auto& primitives = file.model.meshes[static_cast<std::size_t>(mesh)].primitives;
  for (std::size_t i = 0; i < primitives.size(); ++i) {
    const std::string place = fmt::format("meshes[{}].primitives[{}]", mesh, i);
    const int mode = primitives[i].mode;
    if (mode < TINYGLTF_MODE_POINTS || mode > TINYGLTF_MODE_TRIANGLE_FAN) {
      file.report(place + ".mode", "{}: expected 0 to 6: the primitive is left out", mode);
      continue;
    }
    if (mode < TINYGLTF_MODE_TRIANGLES) {
      file.report(place, "points and lines are ignored");
      continue;
    }
    PrimitiveMesh read = read_primitive(file, {primitives[i], weights, place});
    if (read.mesh.triangles.empty()) continue;
    const int material = primitives[i].material;
    if (material >= 0 && file.has(file.model.materials, material, "materials", place + ".material",
                                  "the default material is used")) {
      read.material = material;
    }
    result.push_back(std::move(read));
  }
  return result;
}

}  // namespace pt::gltf
