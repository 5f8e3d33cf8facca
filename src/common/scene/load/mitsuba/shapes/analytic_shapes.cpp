// Shapes of formulas: rectangle, cube, sphere, disk, cylinder.
#include <fmt/format.h>

#include <cmath>

#include "common/math/frame.h"
#include "common/scene/load/files/meshes/move_mesh.h"
#include "common/scene/load/mitsuba/shapes/box_faces.h"
#include "common/scene/load/mitsuba/shapes/shape_kinds.h"
#include "common/scene/load/mitsuba/shapes/tessellate.h"

namespace pt::mitsuba {
namespace {

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
  context.leave_out(shape, shape.element(),
                    fmt::format("radius of shape '{}' is 0; expected a length above 0, or below it "
                                "to turn the normals",
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
