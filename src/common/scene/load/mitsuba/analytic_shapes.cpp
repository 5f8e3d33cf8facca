// Shapes of formulas: rectangle, cube, sphere, disk, cylinder.
//
// (u, v) are Mitsuba's but for v, which Mesh counts from the image's foot. Triangles are
// counterclockwise seen from where the normals point.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "common/geometry/mesh.h"
#include "common/math/transform.h"
#include "common/math/vec.h"
#include "common/scene/load/files/importer.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/mitsuba/scene_parts.h"

namespace pt::mitsuba {
namespace {

/// corner + a edge_a + b edge_b, cross(edge_a, edge_b) pointing out. Mitsuba's (u, v) is (a, b), or
/// (b, a) where swapped.
struct BoxFace {
  Vec3 corner, edge_a, edge_b;
  bool uv_swapped = false;
};

BoxFace rectangle_face() { return {{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}}; }

/// With the (u, v) of Mitsuba 3.9's vertices, which mirror a texture.
std::array<BoxFace, 6> cube_faces() {
  return {{{{-1, -1, -1}, {2, 0, 0}, {0, 0, 2}, true},
           {{1, 1, 1}, {0, 0, -2}, {-2, 0, 0}, true},
           {{1, -1, 1}, {0, 0, -2}, {0, 2, 0}, true},
           {{-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, true},
           {{-1, -1, -1}, {0, 0, 2}, {0, 2, 0}, true},
           {{-1, 1, -1}, {2, 0, 0}, {0, -2, 0}, true}}};
}

constexpr int disk_rings = 64;

/// cos and sin of 2 pi i / n, exact where the circle closes.
Vec2 on_circle(int i, int n) {
  const double angle = 2.0 * std::acos(-1.0) * (i % n) / n;
  return {std::cos(angle), std::sin(angle)};
}

void add_vertex(Mesh& mesh, const Vec3& position, const Vec3& normal, float u, float v) {
  mesh.positions.push_back(position);
  mesh.normals.push_back(normal);
  mesh.uvs.emplace_back(u, 1.0f - v);
}

/// A grid of `columns` x `rows` cells over vertices stored row by row, columns + 1 a row, facing
/// where rows go down and columns to the right. `skip_ends`: the first and last row are poles.
void add_grid(Mesh& mesh, int columns, int rows, bool skip_ends) {
  const auto at = [&](int column, int row) {
    return static_cast<std::uint32_t>(row * (columns + 1) + column);
  };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const std::uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      if (!(skip_ends && j == 0)) mesh.triangles.push_back({{a, c, b}});
      if (!(skip_ends && j == rows - 1)) mesh.triangles.push_back({{a, d, c}});
    }
  }
}

void add_face(Mesh& mesh, const BoxFace& face) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const Vec3 normal = 0.25f * glm::cross(face.edge_a, face.edge_b);
  for (int i = 0; i < 4; ++i) {
    const float a = i == 1 || i == 2 ? 1.0f : 0.0f, b = i >= 2 ? 1.0f : 0.0f;
    add_vertex(mesh, face.corner + a * face.edge_a + b * face.edge_b, normal,
               face.uv_swapped ? b : a, face.uv_swapped ? a : b);
  }
  mesh.triangles.push_back({{first, first + 1, first + 2}});
  mesh.triangles.push_back({{first, first + 2, first + 3}});
}

/// The unit sphere around the origin.
Mesh tessellate_sphere() {
  Mesh mesh;
  for (int j = 0; j <= meridian_segments; ++j) {
    const float v = static_cast<float>(j) / meridian_segments;
    Vec2 ring = on_circle(j, 2 * meridian_segments);  // cos and sin of the angle from the pole
    if (j == meridian_segments) ring.y = 0.0f;
    for (int i = 0; i <= circle_segments; ++i) {
      const Vec2 around = on_circle(i, circle_segments);
      const Vec3 p(ring.y * around.x, ring.y * around.y, ring.x);
      add_vertex(mesh, p, p, static_cast<float>(i) / circle_segments, v);
    }
  }
  add_grid(mesh, circle_segments, meridian_segments, true);
  return mesh;
}

/// The unit disk in the plane z = 0, facing +z; u is the radius, v the angle. Along v it is the
/// longer the farther from the centre, which triangles have for constant: where shading asks for
/// that, each of this many rings is 5 % narrower than the one around it.
Mesh tessellate_disk(int rings) {
  Mesh mesh;
  const Vec3 up(0, 0, 1);
  const auto radius_of = [&](int row) {
    return static_cast<float>(std::pow(0.95, rings - 1 - row));
  };
  for (int j = 0; j < rings && rings > 1; ++j) {
    for (int i = 0; i <= circle_segments; ++i) {
      const Vec2 p = radius_of(j) * on_circle(i, circle_segments);
      add_vertex(mesh, Vec3(p, 0.0f), up, radius_of(j), static_cast<float>(i) / circle_segments);
    }
  }
  add_grid(mesh, circle_segments, rings - 1, false);
  // The centre once a segment: its angle differs.
  const float inner = radius_of(0);
  for (int i = 0; i < circle_segments; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const float v = static_cast<float>(i) / circle_segments;
    const float next = static_cast<float>(i + 1) / circle_segments;
    add_vertex(mesh, Vec3(0.0f), up, 0.0f, 0.5f * (v + next));
    add_vertex(mesh, Vec3(inner * on_circle(i, circle_segments), 0.0f), up, inner, v);
    add_vertex(mesh, Vec3(inner * on_circle(i + 1, circle_segments), 0.0f), up, inner, next);
    mesh.triangles.push_back({{first, first + 1, first + 2}});
  }
  return mesh;
}

/// The side of the cylinder of radius 1 around z, 0 <= z <= 1, facing outward.
Mesh tessellate_cylinder() {
  Mesh mesh;
  for (int j = 0; j <= 1; ++j) {
    for (int i = 0; i <= circle_segments; ++i) {
      const Vec3 normal(on_circle(i, circle_segments), 0.0f);
      const auto z = static_cast<float>(j);
      add_vertex(mesh, normal + Vec3(0, 0, z), normal, static_cast<float>(i) / circle_segments, z);
    }
  }
  add_grid(mesh, circle_segments, 1, false);
  // The rows of vertices go up here, not down: the grid's triangles face inward.
  for (TriangleIndices& t : mesh.triangles) std::swap(t.v[1], t.v[2]);
  return mesh;
}

/// The square [-1, 1]^2 in the plane z = 0, facing +z.
Mesh tessellate_rectangle() {
  Mesh mesh;
  add_face(mesh, rectangle_face());
  return mesh;
}

/// The cube [-1, 1]^3, facing outward; every face shows a texture once.
Mesh tessellate_cube() {
  Mesh mesh;
  for (const BoxFace& face : cube_faces()) add_face(mesh, face);
  return mesh;
}

void add_quad(Context& context, const BoxFace& face, const Affine& to_world, bool turned,
              std::uint32_t material) {
  const Vec3 a = to_world.vector(face.edge_a), b = to_world.vector(face.edge_b);
  const Vec3 corner = to_world.point(face.corner);
  turned ? context.scene.add_quad(corner, b, a, material)
         : context.scene.add_quad(corner, a, b, material);
}

/// A mirroring transform turns the edges, not the normals.
bool turns_edges(const Object& shape, const Affine& to_world) {
  return shape.boolean("flip_normals", false) != (to_world.determinant() < 0.0f);
}

SphereFrame frame_of(const Affine& to_world, float scale, bool inside_out) {
  return {to_world.vector({1, 0, 0}) / scale, to_world.vector({0, 1, 0}) / scale,
          to_world.vector({0, 0, 1}) / scale, inside_out ? -1.0f : 1.0f};
}

/// Not 0; else none, and the shape is left out.
std::optional<float> read_radius(Context& context, const Object& shape) {
  const float radius = shape.number("radius", 1.0f);
  if (radius != 0.0f) return radius;
  context.leave_out(
      shape, shape.element(),
      fmt::format(
          "radius of shape '{}' is 0; expected a length above 0, or below it to turn the normals",
          shape.type()));
  return std::nullopt;
}

}  // namespace

void add_rectangle(Context& context, const Object& shape, const Target& target) {
  const Affine& to_world = target.to_world;
  if (!target.analytic()) {
    return add_mesh(context, shape, target, tessellate_rectangle(), to_world);
  }
  add_quad(context, rectangle_face(), to_world, turns_edges(shape, to_world), target.material);
}

void add_cube(Context& context, const Object& shape, const Target& target) {
  const Affine& to_world = target.to_world;
  if (!target.analytic()) {
    return add_mesh(context, shape, target, tessellate_cube(), to_world);
  }
  for (const BoxFace& face : cube_faces()) {
    add_quad(context, face, to_world, turns_edges(shape, to_world), target.material);
  }
}

void add_sphere(Context& context, const Object& shape, const Target& target) {
  const Vec3 center = shape.vector("center", Vec3(0.0f));
  const std::optional<float> radius = read_radius(context, shape);
  if (!radius) return;
  const Affine& to_world = target.to_world;
  const Affine placed = to_world * translate(center) * scale(Vec3(*radius));
  const std::optional<float> factor = uniform_scale(placed);
  // As Mitsuba 3 has it for spheres; a negative radius mirrors as well.
  const bool inside_out = turns_edges(shape, placed);
  // Lights know spheres that shine outward.
  const bool shines_inward =
      inside_out && !is_black(context.scene.materials[target.material].emission.radiance);
  if (factor && target.group == 0 && !target.needs_mesh && !shines_inward) {
    const Vec3 middle = to_world.point(center);
    if (!target.textured && !inside_out) {
      return context.scene.add_sphere(middle, *factor, target.material);
    }
    return context.scene.add_sphere(middle, *factor, target.material,
                                    frame_of(placed, *factor, inside_out));
  }
  context.warn_once("sphere mesh", shape.element(),
                    "a sphere that is squeezed, repeated, masked, or a lamp that is textured or "
                    "turned inside out: triangles are used");
  Mesh mesh = tessellate_sphere();
  // place_mesh keeps normals outward when mirrored; Mitsuba's spheres do not.
  if (placed.determinant() < 0.0f) {
    for (Vec3& normal : mesh.normals) normal = -normal;
  }
  add_mesh(context, shape, target, std::move(mesh), placed);
}

void add_disk(Context& context, const Object& shape, const Target& target) {
  add_mesh(context, shape, target, tessellate_disk(target.tangents ? disk_rings : 1),
           target.to_world);
}

void add_cylinder(Context& context, const Object& shape, const Target& target) {
  const Vec3 p0 = shape.vector("p0", Vec3(0.0f));
  const Vec3 axis = shape.vector("p1", Vec3(0, 0, 1)) - p0;
  const float length = glm::length(axis);
  const std::optional<float> radius = read_radius(context, shape);
  if (!radius) return;
  if (!(length > 0.0f)) {
    return context.leave_out(shape, shape.element(), "cylinder: p0 and p1 are the same point");
  }
  const Frame frame = make_frame(axis / length);
  Affine place;
  for (int i = 0; i < 3; ++i) {
    place.row[i] = {*radius * frame.tangent[i], *radius * frame.bitangent[i],
                    length * frame.normal[i], p0[i]};
  }
  add_mesh(context, shape, target, tessellate_cylinder(), target.to_world * place);
}

}  // namespace pt::mitsuba
