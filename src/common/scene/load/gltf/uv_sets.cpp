#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "common/scene/load/gltf/document.h"
#include "common/scene/load/gltf/meshes.h"

namespace pt::gltf {
namespace {

using Corners = std::array<Vec2, 3>;

constexpr float tolerance = 1e-4f;       ///< of coordinates: less than half a texel of 4096
constexpr std::size_t parts_max = 4096;  ///< of one primitive

Vec2 mapped(const UvMap& map, const Vec2& uv) {
  return {map.u_row[0] * uv.x + map.u_row[1] * uv.y + map.u_row[2],
          map.v_row[0] * uv.x + map.v_row[1] * uv.y + map.v_row[2]};
}

Corners corners_of(const std::vector<Vec2>& uvs, const TriangleIndices& triangle) {
  return {uvs[triangle.v[0]], uvs[triangle.v[1]], uvs[triangle.v[2]]};
}

/// Twice the signed area.
double area_of(const Corners& c) {
  const auto x = [](const Vec2& a, const Vec2& b) { return double{a.x} - double{b.x}; };
  const auto y = [](const Vec2& a, const Vec2& b) { return double{a.y} - double{b.y}; };
  return x(c[1], c[0]) * y(c[2], c[0]) - x(c[2], c[0]) * y(c[1], c[0]);
}

/// Whether the corners span a plane, as far as floats can tell.
bool spans(const Corners& c) {
  const float longest = std::max(glm::length(c[1] - c[0]), glm::length(c[2] - c[0]));
  return std::abs(area_of(c)) > 1e-5 * double{longest} * double{longest};
}

/// The affine map that takes the corners `from`, which span a plane, to `to`.
UvMap map_between(const Corners& from, const Corners& to) {
  const double area = area_of(from);
  const auto row = [&](int i, float* result) {
    const double a = double{to[1][i]} - double{to[0][i]}, b = double{to[2][i]} - double{to[0][i]};
    const Vec2 p = from[1] - from[0], q = from[2] - from[0];
    const double u = (a * double{q.y} - b * double{p.y}) / area;
    const double v = (b * double{p.x} - a * double{q.x}) / area;
    result[0] = static_cast<float>(u), result[1] = static_cast<float>(v);
    result[2] =
        static_cast<float>(double{to[0][i]} - u * double{from[0].x} - v * double{from[0].y});
  };
  UvMap map;
  row(0, map.u_row), row(1, map.v_row);
  return map;
}

/// The affine map from one set to another with the least squares of errors over all vertices, which
/// evens out what quantised coordinates are off by.
UvMap fitted_map(const std::vector<Vec2>& from, const std::vector<Vec2>& to) {
  using Double2 = std::array<double, 2>;
  const auto mean = [](const std::vector<Vec2>& points) {
    Double2 sum = {};
    for (const Vec2& p : points) sum[0] += double{p.x}, sum[1] += double{p.y};
    const auto n = static_cast<double>(points.size());
    return Double2{sum[0] / n, sum[1] / n};
  };
  const Double2 a = mean(from), b = mean(to);
  double uu = 0, uv = 0, vv = 0;
  Double2 ub = {}, vb = {};
  for (std::size_t i = 0; i < from.size(); ++i) {
    const double u = double{from[i].x} - a[0], v = double{from[i].y} - a[1];
    const Double2 w = {double{to[i].x} - b[0], double{to[i].y} - b[1]};
    uu += u * u, uv += u * v, vv += v * v;
    for (std::size_t k = 0; k < 2; ++k) ub[k] += u * w[k], vb[k] += v * w[k];
  }
  const double determinant = uu * vv - uv * uv;
  UvMap map;
  for (std::size_t k = 0; k < 2 && determinant != 0.0; ++k) {
    float* row = k == 0 ? map.u_row : map.v_row;
    const double x = (ub[k] * vv - vb[k] * uv) / determinant;
    const double y = (vb[k] * uu - ub[k] * uv) / determinant;
    row[0] = static_cast<float>(x), row[1] = static_cast<float>(y);
    row[2] = static_cast<float>(b[k] - x * a[0] - y * a[1]);
  }
  return map;
}

bool serves(const UvMap& map, const Corners& from, const Corners& to) {
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2 off = mapped(map, from[i]) - to[i];
    if (!(std::abs(off.x) < tolerance && std::abs(off.y) < tolerance)) return false;
  }
  return true;
}

/// Triangles of which one set is the mesh's and the others are functions of it.
struct Group {
  int own = 0;
  UvMaps maps;
  std::vector<TriangleIndices> triangles;
};

class Splitter {
 public:
  Splitter(const PrimitiveMesh& primitive, const std::vector<int>& sets)
      : primitive_(primitive), sets_(sets) {}

  /// False where there would be too many parts.
  bool run() {
    Group whole{sets_[0], {}, primitive_.mesh.triangles};
    for (std::size_t i = 1; i < sets_.size(); ++i) {
      whole.maps[sets_[i]] =
          fitted_map(primitive_.uv_sets.at(sets_[0]), primitive_.uv_sets.at(sets_[i]));
    }
    const auto is_served = [&](const TriangleIndices& t) { return belongs(whole, t); };
    if (std::ranges::all_of(whole.triangles, is_served)) {
      groups_.push_back(std::move(whole));
      return true;
    }
    return std::ranges::all_of(primitive_.mesh.triangles,
                               [&](const TriangleIndices& t) { return add(t); });
  }

  std::vector<UvPart> parts() const {
    std::vector<UvPart> result;
    for (const Group& group : groups_) result.push_back({mesh_of(group), group.maps});
    return result;
  }

 private:
  Corners corners(int set, const TriangleIndices& t) const {
    return corners_of(primitive_.uv_sets.at(set), t);
  }

  bool belongs(const Group& group, const TriangleIndices& t) const {
    const Corners from = corners(group.own, t);
    // A triangle without extent in the group's own set has it in another's.
    return (spans(from) || !spans(corners(own_set(t), t))) &&
           std::ranges::all_of(group.maps, [&](const auto& entry) {
             return serves(entry.second, from, corners(entry.first, t));
           });
  }

  int own_set(const TriangleIndices& t) const {
    const auto wide = std::ranges::find_if(sets_, [&](int s) { return spans(corners(s, t)); });
    return wide == sets_.end() ? sets_[0] : *wide;
  }

  bool add(const TriangleIndices& t) {
    // Charts come one after the other, so the last group is the likeliest.
    constexpr std::size_t looked_at = 64;
    for (std::size_t i = groups_.size(), n = 0; i-- > 0 && n < looked_at; ++n) {
      if (belongs(groups_[i], t)) return groups_[i].triangles.push_back(t), true;
    }
    if (groups_.size() == parts_max) return false;
    Group group{own_set(t), {}, {t}};
    const Corners from = corners(group.own, t);
    for (const int set : sets_) {
      if (set == group.own) continue;
      const Corners to = corners(set, t);
      if (spans(from)) {
        group.maps[set] = map_between(from, to);
      } else {
        group.maps[set] = {{0, 0, to[0].x}, {0, 0, to[0].y}};
      }
    }
    groups_.push_back(std::move(group));
    return true;
  }

  /// Its triangles with the vertices that they have.
  Mesh mesh_of(const Group& group) const {
    const Mesh& all = primitive_.mesh;
    const std::vector<Vec2>& uvs = primitive_.uv_sets.at(group.own);
    Mesh mesh;
    if (group.triangles.size() == all.triangles.size()) {
      mesh = all;
      mesh.uvs = uvs;
      return mesh;
    }
    std::map<std::uint32_t, std::uint32_t> numbers;
    for (TriangleIndices t : group.triangles) {
      for (std::uint32_t& v : t.v) {
        const auto [entry, is_new] =
            numbers.try_emplace(v, static_cast<std::uint32_t>(mesh.positions.size()));
        if (is_new) {
          mesh.positions.push_back(all.positions[v]);
          mesh.uvs.push_back(uvs[v]);
          if (!all.normals.empty()) mesh.normals.push_back(all.normals[v]);
          if (!all.colors.empty()) mesh.colors.push_back(all.colors[v]);
        }
        v = entry->second;
      }
      mesh.triangles.push_back(t);
    }
    return mesh;
  }

  const PrimitiveMesh& primitive_;
  const std::vector<int>& sets_;
  std::vector<Group> groups_;
};

}  // namespace

std::vector<int> sets_of_textures(const File& file, int material) {
  if (material < 0) return {};
  const tinygltf::Material& m = file.model.materials[static_cast<std::size_t>(material)];
  std::map<int, int> uses;
  const auto count = [&](const TextureUse& use, int weight = 1) {
    if (use) uses[use.tex_coord] += weight;
  };
  constexpr int more_than_all = 100;
  count(texture_use(m.normalTexture), more_than_all);
  count(texture_use(m.pbrMetallicRoughness.baseColorTexture), 2);
  count(texture_use(m.pbrMetallicRoughness.metallicRoughnessTexture));
  count(texture_use(m.emissiveTexture));
  for (const auto& [extension, key] :
       {std::pair{"KHR_materials_transmission", "transmissionTexture"},
        std::pair{"KHR_materials_clearcoat", "clearcoatTexture"},
        std::pair{"KHR_materials_sheen", "sheenColorTexture"},
        std::pair{"KHR_materials_pbrSpecularGlossiness", "diffuseTexture"}}) {
    if (const auto* value = find_extension(m.extensions, extension)) {
      count(texture_use(member(*value, key)));
    }
  }
  std::vector<int> sets;
  for (const auto& [set, number] : uses) sets.push_back(set);
  std::ranges::stable_sort(sets, std::greater<>(), [&](int set) { return uses[set]; });
  return sets;
}

std::vector<UvPart> split_by_uv_sets(File& file, PrimitiveMesh primitive, std::vector<int> sets,
                                     const std::string& place) {
  const auto is_missing = [&](int set) { return !primitive.uv_sets.contains(set); };
  if (sets.empty()) {
    sets.push_back(0);
  } else if (const auto missing = std::ranges::find_if(sets, is_missing); missing != sets.end()) {
    file.report_value(place, "TEXCOORD is missing",
                      "TEXCOORD_{} is missing, which a texture of its material uses: {} used",
                      *missing, primitive.uv_sets.empty() ? "none is" : "another set is");
  }
  std::erase_if(sets, is_missing);
  if (sets.empty() && !primitive.uv_sets.empty()) sets.push_back(primitive.uv_sets.begin()->first);
  if (sets.empty()) return {{std::move(primitive.mesh), {}}};
  if (sets.size() > 1) {
    Splitter splitter(primitive, sets);
    if (splitter.run()) return splitter.parts();
    file.report(place,
                "textures with different texture coordinates in more than {} pieces: TEXCOORD_{} "
                "is used for all",
                parts_max, sets[0]);
  }
  primitive.mesh.uvs = std::move(primitive.uv_sets.at(sets[0]));
  return {{std::move(primitive.mesh), {}}};
}

}  // namespace pt::gltf
