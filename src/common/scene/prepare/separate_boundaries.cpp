// Boundaries of media that lie in other surfaces: fog that stands on a floor.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "common/scene/prepare/prepare_steps.h"

namespace pt {
namespace {

using DVec3 = glm::dvec3;
using Corners = std::array<DVec3, 3>;

/// Where instances have more triangles than this, none of them is looked at.
constexpr std::uint64_t placed_triangles_max = std::uint64_t{1} << 24;

/// A mesh where the scene has it.
struct PlacedMesh {
  std::uint32_t mesh;
  const Affine* to_world;  ///< null: in the world

  DVec3 vector(const DVec3& v) const {
    if (to_world == nullptr) return v;
    DVec3 result;
    for (int i = 0; i < 3; ++i) result[i] = glm::dot(DVec3(Vec3(to_world->row[i])), v);
    return result;
  }
  DVec3 point(const Vec3& p) const {
    return to_world == nullptr ? DVec3(p) : vector(DVec3(p)) + DVec3(to_world->translation());
  }
  /// In the order about the surface's normal, also where it is mirrored.
  Corners corners(const Mesh& m, std::uint32_t triangle) const {
    const auto& v = m.triangles[triangle].v;
    Corners c = {point(m.positions[v[0]]), point(m.positions[v[1]]), point(m.positions[v[2]])};
    if (to_world != nullptr && to_world->determinant() < 0.0f) std::swap(c[1], c[2]);
    return c;
  }
};

struct Box {
  DVec3 low{HUGE_VAL}, high{-HUGE_VAL};

  void grow(const DVec3& p) { low = glm::min(low, p), high = glm::max(high, p); }
  bool overlaps(const Box& b) const {
    return glm::all(glm::lessThanEqual(low, b.high)) && glm::all(glm::lessThanEqual(b.low, high));
  }
};

Box box_of(const Corners& corners, double margin = 0) {
  Box box;
  for (const DVec3& c : corners) box.grow(c - DVec3(margin)), box.grow(c + DVec3(margin));
  return box;
}

/// How far a triangle and a ray that leaves it may be apart: as triangle_surface().
double error_bound(const Corners& c) {
  double extent = 0, size = 0;
  for (int i = 0; i < 3; ++i) {
    extent = std::max(extent, glm::length(c[i]));
    size = std::max(size, glm::length(c[i] - c[(i + 1) % 3]));
  }
  return double{half_ulp} * (16 * extent + 8 * size);
}

DVec3 normal_of(const Corners& c) {
  const DVec3 n = glm::cross(c[1] - c[0], c[2] - c[0]);
  const double length = glm::length(n);
  return length > 0 ? n / length : DVec3(0.0);
}

/// The part of `a` over which `b` lies, as seen along a's normal.
std::vector<DVec3> overlap(const Corners& a, const Corners& b, const DVec3& normal) {
  std::vector<DVec3> part(a.begin(), a.end()), next;
  const double turn = glm::dot(normal_of(b), normal) < 0 ? -1 : 1;
  for (int i = 0; i < 3; ++i) {
    const DVec3 inward = turn * glm::cross(normal, b[(i + 1) % 3] - b[i]);
    const auto height = [&](const DVec3& p) { return glm::dot(p - b[i], inward); };
    next.clear();
    for (std::size_t k = 0; k < part.size(); ++k) {
      const DVec3 &from = part[k], &to = part[(k + 1) % part.size()];
      const double h0 = height(from), h1 = height(to);
      if (h0 >= 0) next.push_back(from);
      if ((h0 >= 0) != (h1 >= 0)) next.push_back(from + h0 / (h0 - h1) * (to - from));
    }
    part.swap(next);
  }
  return part;
}

double area_of(const std::vector<DVec3>& polygon) {
  DVec3 sum(0.0);
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    sum += glm::cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  }
  return 0.5 * glm::length(sum);
}

/// Whether rays cannot tell in which order they hit the two; `between`: how far b is in front.
bool touch(const Corners& a, const Corners& b, double tolerance, double& between) {
  const DVec3 n = normal_of(a), n_b = normal_of(b);
  const double cosine = glm::dot(n, n_b);
  if (std::abs(cosine) < 0.999) return false;
  const std::vector<DVec3> part = overlap(a, b, n);
  const std::vector<DVec3> all_a(a.begin(), a.end()), all_b(b.begin(), b.end());
  if (part.size() < 3 || area_of(part) < 1e-5 * std::min(area_of(all_a), area_of(all_b))) {
    return false;
  }
  between = 0;
  for (const DVec3& p : part) {
    const double height = glm::dot(n_b, b[0] - p) / cosine;
    if (std::abs(height) > tolerance) return false;
    between += height / static_cast<double>(part.size());
  }
  return true;
}

/// Boundaries' triangles by the cells of a grid.
class TriangleGrid {
 public:
  void add(const Box& box) { boxes_.push_back(box), all_.grow(box.low), all_.grow(box.high); }
  std::size_t count() const { return boxes_.size(); }
  const Box& all() const { return all_; }

  void build() {
    cells_ = std::clamp(static_cast<int>(std::cbrt(static_cast<double>(count()))), 1, 128);
    lists_.resize(static_cast<std::size_t>(cells_) * cells_ * cells_);
    for (std::uint32_t i = 0; i < boxes_.size(); ++i) {
      for_cells(boxes_[i], [&](std::size_t cell) { lists_[cell].push_back(i); });
    }
    asked_by_.assign(count(), 0);
  }

  /// Calls function(i) once for each box i that overlaps this one.
  template <class Function>
  void find(const Box& box, Function&& function) {
    if (!all_.overlaps(box)) return;
    ++query_;
    for_cells(box, [&](std::size_t cell) {
      for (const std::uint32_t i : lists_[cell]) {
        if (asked_by_[i] == query_ || !boxes_[i].overlaps(box)) continue;
        asked_by_[i] = query_;
        function(i);
      }
    });
  }

 private:
  template <class Function>
  void for_cells(const Box& box, Function&& function) const {
    std::array<int, 3> first{}, last{};
    for (int i = 0; i < 3; ++i) {
      const double size = std::max(all_.high[i] - all_.low[i], 1e-300);
      const auto cell = [&](double x) {
        return static_cast<int>(std::clamp((x - all_.low[i]) / size * cells_, 0.0, cells_ - 1.0));
      };
      first[i] = cell(box.low[i]), last[i] = cell(box.high[i]);
    }
    for (int z = first[2]; z <= last[2]; ++z) {
      for (int y = first[1]; y <= last[1]; ++y) {
        for (int x = first[0]; x <= last[0]; ++x) {
          function(static_cast<std::size_t>(x + cells_ * (y + cells_ * z)));
        }
      }
    }
  }

  std::vector<Box> boxes_;
  Box all_;
  int cells_ = 1;
  std::vector<std::vector<std::uint32_t>> lists_;
  std::vector<std::uint64_t> asked_by_;
  std::uint64_t query_ = 0;
};

bool lets_light_through(const Material& material) {
  return material.is(Material::passes) || !reflects_only(material.kind);
}

/// What else touches an opaque boundary is moved.
bool may_move(const Material& material) {
  return material.is(Material::boundary) && lets_light_through(material);
}

/// Where a boundary has to go as seen from a surface in its plane.
enum class Side { inward, outward, outward_or_inward };

/// The order in which light has to reach the two, on its way from inside the boundary `p` outwards:
/// each must begin in the medium in which the other ends.
Side side_of(const SceneData& scene, std::uint32_t p, std::uint32_t q, bool opposing, bool first) {
  const Material& other = scene.material_records[q];
  if (!other.is(Material::boundary)) {
    const bool may_contain =
        scene.material_records[p].is(Material::passes) || !lets_light_through(other);
    return may_contain ? Side::outward_or_inward : Side::inward;
  }
  const MediumBoundary& of_p = scene.boundaries[p];
  MediumBoundary of_q = scene.boundaries[q];
  if (opposing) std::swap(of_q.inside, of_q.outside);
  if (of_p.outside == of_q.inside) return Side::inward;
  if (of_p.inside == (lets_light_through(other) ? of_q.outside : of_q.inside)) return Side::outward;
  return opposing || first ? Side::inward : Side::outward;
}

struct Touch {
  std::uint32_t mesh, triangle;
  Side side;
  DVec3 normal;     ///< in the mesh's space, of unit length
  double distance;  ///< to go along it
};

class Separator {
 public:
  explicit Separator(SceneData& scene) : scene_(scene) {
    std::uint64_t placed = 0;
    std::vector<PlacedMesh> instances;
    for (std::uint32_t i = 0; i < scene.meshes.size(); ++i) {
      if (scene.meshes[i].group == 0) add(PlacedMesh{i, nullptr});
    }
    for (const Instance& instance : scene.instances) {
      for (std::uint32_t i = 0; i < scene.meshes.size(); ++i) {
        if (scene.meshes[i].group != instance.group) continue;
        instances.push_back({i, &instance.to_world});
        placed += scene.meshes[i].triangles.size();
        if (placed > placed_triangles_max) return;
      }
    }
    for (const PlacedMesh& place : instances) add(place);
  }

  void run() {
    if (grid_.count() == 0) return;
    grid_.build();
    for (const PlacedMesh& other : others_) look_at(other);
    move();
  }

 private:
  struct BoundaryTriangle {
    PlacedMesh place;
    std::uint32_t triangle;
    Corners corners;
    double error;
  };

  void add(const PlacedMesh& place) {
    others_.push_back(place);
    const Mesh& mesh = scene_.meshes[place.mesh];
    if (!may_move(scene_.material_records[mesh.material])) return;
    const DVec3 camera(scene_.camera.look_from);
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const Corners corners = place.corners(mesh, i);
      const double error =
          error_bound(corners) + 4 * double{half_ulp} * glm::length(corners[0] - camera);
      boundaries_.push_back({place, i, corners, error});
      grid_.add(box_of(corners, error));
    }
  }

  void look_at(const PlacedMesh& other) {
    const Mesh& mesh = scene_.meshes[other.mesh];
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const Corners corners = other.corners(mesh, i);
      const double error = error_bound(corners);
      grid_.find(box_of(corners, error), [&](std::uint32_t k) {
        const BoundaryTriangle& boundary = boundaries_[k];
        const bool same_mesh = boundary.place.mesh == other.mesh;
        if (same_mesh && boundary.place.to_world == other.to_world && boundary.triangle == i)
          return;
        compare(boundary, other, i, corners, error + boundary.error);
      });
    }
  }

  void compare(const BoundaryTriangle& p, const PlacedMesh& other, std::uint32_t triangle,
               const Corners& corners, double tolerance) {
    double between = 0;
    if (!touch(p.corners, corners, tolerance, between)) return;
    const Mesh& mesh = scene_.meshes[p.place.mesh];
    const DVec3 n = normal_of(p.corners);
    const bool opposing = glm::dot(n, normal_of(corners)) < 0;
    // The other side of a thin wall.
    if (opposing && between < 0 && p.place.mesh == other.mesh) return;
    const bool first = std::pair(p.place.mesh, p.triangle) < std::pair(other.mesh, triangle);
    const Side side =
        side_of(scene_, mesh.material, scene_.meshes[other.mesh].material, opposing, first);
    const DVec3 own = normal_of(PlacedMesh{p.place.mesh, nullptr}.corners(mesh, p.triangle));
    const double scale = glm::dot(p.place.vector(own), n);
    if (!(scale > 0)) return;
    touches_.push_back({p.place.mesh, p.triangle, side, own, 3 * tolerance / scale});
  }

  /// What must go one way first; then what may go either, outwards unless it has gone already.
  void move() {
    std::ranges::stable_sort(touches_, {}, &Touch::side);
    std::map<std::pair<std::uint32_t, std::uint32_t>, DVec3> moved;  // by mesh and vertex
    for (const Touch& touch : touches_) {
      const DVec3 way = touch.side == Side::inward ? -touch.normal : touch.normal;
      for (const std::uint32_t v : scene_.meshes[touch.mesh].triangles[touch.triangle].v) {
        DVec3& by = moved.try_emplace({touch.mesh, v}, 0.0).first->second;
        const double gone = glm::dot(by, way);
        const bool has_gone_back = gone < -0.5 * touch.distance;
        if (gone < touch.distance && !has_gone_back) by += (touch.distance - gone) * way;
      }
    }
    for (const auto& [vertex, by] : moved) {
      Mesh& mesh = scene_.meshes[vertex.first];
      const auto move = [&](Vec3& p) { p = Vec3(DVec3(p) + by); };
      move(mesh.positions[vertex.second]);
      for (std::vector<Vec3>& positions : mesh.later_positions) move(positions[vertex.second]);
    }
  }

  SceneData& scene_;
  std::vector<PlacedMesh> others_;
  std::vector<BoundaryTriangle> boundaries_;
  TriangleGrid grid_;
  std::vector<Touch> touches_;
};

/// A ball of fog in a shell of the same size. Spheres of one centre.
void separate_spheres(SceneData& scene) {
  const std::vector<Sphere> spheres = scene.spheres;
  std::vector<std::size_t> passing;
  const auto material = [&](std::size_t i) -> const Material& {
    return scene.material_records[scene.sphere_material[i]];
  };
  const auto normals = [&](std::size_t i) {
    return scene.sphere_frames.empty() ? 1.0f : scene.sphere_frames[i].side;
  };
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    if (may_move(material(i))) passing.push_back(i);
  }
  for (const std::size_t p : passing) {
    const float radius = spheres[p].radius();
    const float error =
        16.0f * half_ulp * (max_abs(spheres[p].center) + radius + max_abs(scene.camera.look_from));
    for (std::size_t q = 0; q < spheres.size(); ++q) {
      const float apart =
          max_abs(spheres[q].center - spheres[p].center) + fabsf(spheres[q].radius() - radius);
      if (q == p || apart > 2.0f * error) continue;
      const Side side = side_of(scene, scene.sphere_material[p], scene.sphere_material[q],
                                normals(p) != normals(q), p < q);
      const float by = 6.0f * error * normals(p) * (side == Side::inward ? -1.0f : 1.0f);
      scene.spheres[p].radius_squared = (radius + by) * (radius + by);
      break;
    }
  }
}

}  // namespace

void separate_boundaries(SceneData& scene) {
  Separator(scene).run();
  separate_spheres(scene);
}

}  // namespace pt
