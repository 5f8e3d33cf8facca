#include "common/scene/load/pbrt/shapes/place_shape.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/geometry/bounds.h"
#include "common/scene/load/files/meshes/move_mesh.h"
#include "common/scene/load/pbrt/description/transforms.h"
#include "common/scene/load/pbrt/shapes/map_vertices.h"

namespace pt::pbrt {
namespace {

double area_of(const Mesh& mesh) {
  double sum = 0;
  for (const TriangleIndices& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.v[0]]), b(mesh.positions[t.v[1]]),
        c(mesh.positions[t.v[2]]);
    sum += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  return sum;
}

/// The light of a given power: in pbrt each triangle has all of it, but a quadric is one shape.
void set_power(Context& context, const ShapeEntity& entity, const ShapeMaterial& shape, double area,
               std::size_t parts, MaterialDescription& material) {
  if (!(shape.power > 0.0f)) return;
  const double sides = shape.two_sided ? 2 : 1;
  const double k = sides * area * double{pi} * static_cast<double>(shape.light_mean);
  if (!(k > 0)) return;
  if (parts > 2) {
    context.reporter.warn_once("power of meshes", entity.shape.parameters.place(),
                               "'power' of a light of many triangles, each of which has it in "
                               "pbrt: all get the mean radiance");
  }
  material.emission.radiance *= static_cast<float>(shape.power * static_cast<double>(parts) / k);
}

/// Quadrics: a transformation that mirrors turns their surface inside out, but (in pbrt's light
/// sampling) not their light. Else: normals are transformed as they are, and a winding that was
/// mirrored is turned back.
bool turns(const ShapeEntity& entity, bool is_quadric, bool emits) {
  const bool mirrors = entity.shape.to_world.determinant() < 0.0f;
  return entity.reverse != (is_quadric && mirrors && !emits);
}

}  // namespace

void place_mesh(Context& context, const ShapeEntity& entity, const ShapeMaterial& shape,
                bool is_quadric, Mesh mesh) {
  const Affine& to_world = entity.shape.to_world;
  if (mesh.uvs.empty() && shape.textured && shape.mapping.is_uv()) add_default_uvs(mesh);
  transform_mesh(mesh, to_world);
  if (shape.textured) map_vertices(mesh, shape.mapping);
  for (const Vec3& p : mesh.positions) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      fail(entity.shape.parameters.place(), "a shape that reaches farther than numbers do");
    }
  }
  if (turns(entity, is_quadric, shape.emits)) turn_mesh(mesh);
  if (!mesh.normals.empty()) {
    wind_by_normals(mesh);
  } else if (to_world.determinant() < 0.0f) {
    turn_mesh(mesh);
  }
  if (!shape.textured) mesh.uvs.clear();
  MaterialDescription material = shape.material;
  const std::size_t parts = is_quadric ? 1 : mesh.triangles.size();
  set_power(context, entity, shape, area_of(mesh), parts, material);
  mesh.material = context.add_material(material);
  mesh.group = entity.group;
  if (shape.two_sided && shape.emits) {
    Mesh back = back_of(mesh);
    std::swap(material.media.inside, material.media.outside);
    back.material = context.add_material(material);
    context.scene.meshes.push_back(std::move(mesh));
    context.scene.meshes.push_back(std::move(back));
  } else {
    context.scene.meshes.push_back(std::move(mesh));
  }
}

bool place_sphere(Context& context, const ShapeEntity& entity, const ShapeMaterial& shape,
                  float radius) {
  const Affine& to_world = entity.shape.to_world;
  const std::optional<float> factor = uniform_scale(to_world);
  const bool inside_out = turns(entity, true, shape.emits);
  if (!factor || entity.group != 0 || (shape.textured && !shape.mapping.is_uv()) ||
      !shape.material.opacity.is_opaque() || shape.material.emission.texture != no_texture ||
      (shape.emits && (inside_out || shape.two_sided))) {
    return false;
  }
  MaterialDescription material = shape.material;
  const double size = double{*factor} * double{radius};
  set_power(context, entity, shape, 4 * double{pi} * size * size, 1, material);
  const std::uint32_t number = context.add_material(material);
  const Vec3 center = to_world.translation();
  if (!shape.textured && !inside_out) {
    context.scene.add_sphere(center, static_cast<float>(size), number);
    return true;
  }
  const auto axis = [&](const Vec3& a) { return to_world.vector(a) / *factor; };
  context.scene.add_sphere(
      center, static_cast<float>(size), number,
      {axis({1, 0, 0}), axis({0, 1, 0}), axis({0, 0, 1}), inside_out ? -1.0f : 1.0f});
  return true;
}

}  // namespace pt::pbrt
