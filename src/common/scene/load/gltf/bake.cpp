// Meshes into world space, by their node or by joints.
#include <algorithm>
#include <cmath>
#include <utility>

#include "common/scene/load/gltf/document.h"
#include "common/scene/load/gltf/meshes.h"

namespace pt::gltf {

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
