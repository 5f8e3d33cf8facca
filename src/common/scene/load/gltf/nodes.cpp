#include "common/scene/load/gltf/nodes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/scene/load/gltf/document.h"
#include "common/scene/load/gltf/meshes.h"

namespace pt::gltf {
namespace {

using Numbers = std::vector<double>;

/// Whether the values can be used; if not, that is reported.
bool are_numbers(File& file, const Numbers& values, std::size_t count, const std::string& place) {
  const auto is_finite = [](double x) { return std::isfinite(static_cast<float>(x)); };
  if (values.size() == count && std::all_of(values.begin(), values.end(), is_finite)) return true;
  file.report(place, "expected {} finite numbers: it is left out", count);
  return false;
}

Vec3 to_vec3(const Numbers& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

Affine from_matrix(File& file, const Numbers& m, const std::string& place) {
  if (!are_numbers(file, m, 16, place)) return {};
  const double off =
      std::max({std::abs(m[3]), std::abs(m[7]), std::abs(m[11]), std::abs(m[15] - 1)});
  if (off > 1e-5) file.report(place, "expected a last row of 0, 0, 0, 1, which is used");
  Affine result;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 4; ++column) {
      result.row[row][static_cast<int>(column)] = static_cast<float>(m[4 * column + row]);
    }
  }
  return result;
}

/// The rotation of a quaternion x, y, z, w, which need not have unit length.
Affine from_quaternion(File& file, const Numbers& q, const std::string& place) {
  if (!are_numbers(file, q, 4, place)) return {};
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(length > 0)) {
    file.report(place, "expected a quaternion that is not zero: nothing is rotated");
    return {};
  }
  const double x = q[0] / length, y = q[1] / length, z = q[2] / length, w = q[3] / length;
  const auto row = [](double a, double b, double c) {
    return Vec4(static_cast<float>(a), static_cast<float>(b), static_cast<float>(c), 0.0f);
  };
  return {{row(1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
           row(2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
           row(2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y))}};
}

/// matrix, or translation * rotation * scale
Affine local_transform(File& file, const tinygltf::Node& node, const std::string& place) {
  if (!node.matrix.empty()) return from_matrix(file, node.matrix, place + ".matrix");
  Affine result;
  if (!node.translation.empty() && are_numbers(file, node.translation, 3, place + ".translation")) {
    result = translate(to_vec3(node.translation));
  }
  if (!node.rotation.empty()) {
    result = result * from_quaternion(file, node.rotation, place + ".rotation");
  }
  if (!node.scale.empty() && are_numbers(file, node.scale, 3, place + ".scale")) {
    result = result * scale(to_vec3(node.scale));
  }
  return result;
}

/// The default scene's nodes, or all nodes without a parent where the file has no scenes.
std::vector<int> root_nodes(File& file) {
  const auto& model = file.model;
  if (!model.scenes.empty()) {
    const int scene = std::max(model.defaultScene, 0);
    const bool is_there = file.has(model.scenes, scene, "scenes", "scene", "the first is used");
    return model.scenes[is_there ? static_cast<std::size_t>(scene) : 0].nodes;
  }
  std::vector<bool> has_parent(model.nodes.size());
  for (const auto& node : model.nodes) {
    for (const int child : node.children) {
      if (static_cast<std::size_t>(child) < has_parent.size()) {
        has_parent[static_cast<std::size_t>(child)] = true;
      }
    }
  }
  std::vector<int> roots;
  for (std::size_t i = 0; i < has_parent.size(); ++i) {
    if (!has_parent[i]) roots.push_back(static_cast<int>(i));
  }
  return roots;
}

bool is_finite(const Affine& m) {
  for (const Vec4& row : m.row) {
    if (!std::isfinite(row.x + row.y + row.z + row.w)) return false;
  }
  return true;
}

}  // namespace

std::string node_place(int node) { return fmt::format("nodes[{}]", node); }

std::vector<PlacedNode> place_nodes(File& file) {
  const auto& nodes = file.model.nodes;
  std::vector<PlacedNode> result;
  std::vector<bool> seen(nodes.size());
  // A stack rather than recursion: a chain of nodes may be as long as the file.
  std::vector<PlacedNode> waiting;
  const auto push = [&](const std::vector<int>& children, const Affine& parent,
                        const std::string& place) {
    for (auto child = children.rbegin(); child != children.rend(); ++child) {
      if (file.has(nodes, *child, "nodes", place, "it is left out")) {
        waiting.push_back({*child, parent});
      }
    }
  };
  push(root_nodes(file), Affine{}, "scenes");
  while (!waiting.empty()) {
    PlacedNode placed = waiting.back();
    waiting.pop_back();
    const auto index = static_cast<std::size_t>(placed.node);
    const std::string place = node_place(placed.node);
    if (seen[index]) {
      file.report(place, "a cycle or two parents: nodes form trees, so it is placed once");
      continue;
    }
    seen[index] = true;
    placed.to_world = placed.to_world * local_transform(file, nodes[index], place);
    if (!is_finite(placed.to_world)) {
      file.report(place, "its transformation overflows: it is left out with its children");
      continue;
    }
    result.push_back(placed);
    push(nodes[index].children, placed.to_world, place + ".children");
  }
  return result;
}

// Meshes into world space, by their node or by joints.

Cofactors::Cofactors(const Affine& map) {
  const Vec3 x = map.vector({1, 0, 0}), y = map.vector({0, 1, 0}), z = map.vector({0, 0, 1});
  columns[0] = glm::cross(y, z), columns[1] = glm::cross(z, x), columns[2] = glm::cross(x, y);
}

void bake(File& file, const Affine& to_world, const std::string& place, Mesh& mesh) {
  for (Vec3& p : mesh.positions) p = to_world.point(p);
  const Cofactors cofactors(to_world);
  for (Vec3& n : mesh.normals) n = cofactors.normal(n);
  finish_baking(file, to_world.determinant() < 0.0f, place, mesh);
}

void finish_baking(File& file, bool mirrors, const std::string& place, Mesh& mesh) {
  const auto overflows = [&](std::uint32_t v) {
    const Vec3& p = mesh.positions[v];
    return !std::isfinite(p.x + p.y + p.z);
  };
  const std::size_t lost = std::erase_if(mesh.triangles, [&](const TriangleIndices& t) {
    return overflows(t.v[0]) || overflows(t.v[1]) || overflows(t.v[2]);
  });
  if (lost > 0) {
    file.report(place, "a vertex in world space overflows: its triangles are left out");
    const Vec3 used = mesh.triangles.empty() ? Vec3(0.0f) : mesh.positions[mesh.triangles[0].v[0]];
    for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
      if (overflows(v)) mesh.positions[v] = used;
    }
  }
  if (mirrors) {
    for (TriangleIndices& t : mesh.triangles) std::swap(t.v[1], t.v[2]);
  }
  for (Vec3& n : mesh.normals) {
    const float length = glm::length(n);
    if (!(length > 0.0f) || !std::isfinite(length)) {
      mesh.normals.clear();
      break;
    }
    n *= (mirrors ? -1.0f : 1.0f) / length;
  }
}

namespace {

/// Column by column, as glTF has them; a last row is not looked at.
std::vector<Affine> inverse_bind_matrices(const File& file, const tinygltf::Skin& skin,
                                          const std::string& place) {
  std::vector<Affine> result(skin.joints.size());
  if (skin.inverseBindMatrices < 0) return result;
  const std::vector<float> values =
      read_floats(file, skin.inverseBindMatrices, 16, place + ".inverseBindMatrices");
  for (std::size_t i = 0; i < std::min(result.size(), values.size() / 16); ++i) {
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t column = 0; column < 4; ++column) {
        result[i].row[row][static_cast<int>(column)] = values[16 * i + 4 * column + row];
      }
    }
  }
  return result;
}

}  // namespace

std::vector<Affine> joint_matrices(File& file, int skin,
                                   const std::unordered_map<int, Affine>& places,
                                   const std::string& place) {
  constexpr const char* instead = "the mesh is placed by its node";
  if (!file.has(file.model.skins, skin, "skins", place + ".skin", instead)) return {};
  const auto& source = file.model.skins[static_cast<std::size_t>(skin)];
  const std::string skin_place = fmt::format("skins[{}]", skin);
  std::vector<Affine> result = inverse_bind_matrices(file, source, skin_place);
  for (std::size_t i = 0; i < result.size(); ++i) {
    const auto joint = places.find(source.joints[i]);
    if (joint == places.end()) {
      file.report(skin_place, "a joint that is not in the scene: {}", instead);
      return {};
    }
    result[i] = joint->second * result[i];
  }
  return result;
}

void apply_skin(File& file, const std::vector<Affine>& joints, const Influences& influences,
                const std::string& place, Mesh& mesh) {
  std::size_t mirrored = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    Affine map{{Vec4(0.0f), Vec4(0.0f), Vec4(0.0f)}};
    for (std::size_t i = v * influences.per_vertex; i < (v + 1) * influences.per_vertex; ++i) {
      if (influences.weights[i] == 0.0f) continue;
      if (influences.joints[i] >= joints.size()) {
        file.report_value(place, "joint", "joint {}, the skin has {}: it moves nothing",
                          influences.joints[i], joints.size());
        continue;
      }
      for (int row = 0; row < 3; ++row) {
        map.row[row] += influences.weights[i] * joints[influences.joints[i]].row[row];
      }
    }
    mesh.positions[v] = map.point(mesh.positions[v]);
    mirrored += map.determinant() < 0.0f;
    if (!mesh.normals.empty()) mesh.normals[v] = Cofactors(map).normal(mesh.normals[v]);
  }
  finish_baking(file, 2 * mirrored > mesh.positions.size(), place, mesh);
}

}  // namespace pt::gltf
