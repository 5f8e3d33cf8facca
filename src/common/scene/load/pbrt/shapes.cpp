// Shapes to spheres and meshes, objects to groups and instances.
#include <algorithm>
#include <cmath>
#include <set>

#include "common/geometry/bounds.h"
#include "common/geometry/mesh.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/pbrt/scene_parts.h"
#include "common/scene/load/pbrt/syntax/context.h"
#include "common/scene/load/pbrt/syntax/description.h"

namespace pt::pbrt {
namespace {

/// The same triangles, which share no vertex; without texture coordinates.
Mesh split_mesh(const Mesh& mesh) {
  Mesh split;
  for (const TriangleIndices& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(split.positions.size());
    for (const std::uint32_t v : t.v) {
      split.positions.push_back(mesh.positions[v]);
      if (!mesh.normals.empty()) split.normals.push_back(mesh.normals[v]);
    }
    split.triangles.push_back({{first, first + 1, first + 2}});
  }
  return split;
}

/// Which coordinate of a round mapping returns to where it began: around the axis.
int closed_coordinate(MappingKind kind) { return kind == MappingKind::spherical ? 1 : 0; }

/// On the axis there is no angle around it.
bool is_on_axis(const TextureMapping& mapping, const Vec3& point) {
  const Vec3 p = mapping.to_texture.point(point);
  return std::hypot(p.x, p.y) <= 1e-6f * glm::length(p);
}

/// Brings the angles of a triangle's vertices beside each other, where it lies across the seam.
void close_seam(Mesh& mesh, const TriangleIndices& triangle, const TextureMapping& mapping) {
  const int c = closed_coordinate(mapping.kind);
  float sum = 0.0f, first = 0.0f;
  int count = 0;
  for (const std::uint32_t v : triangle.v) {
    if (is_on_axis(mapping, mesh.positions[v])) continue;
    float& turn = mesh.uvs[v][c];
    if (count == 0) first = turn;
    turn -= std::round(turn - first);
    sum += turn;
    ++count;
  }
  for (const std::uint32_t v : triangle.v) {
    if (count > 0 && is_on_axis(mapping, mesh.positions[v])) {
      mesh.uvs[v][c] = sum / static_cast<float>(count);
    }
  }
}

/// Each triangle gets vertices of its own with the coordinates that pbrt gives it.
void add_default_uvs(Mesh& mesh) {
  mesh = split_mesh(mesh);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    mesh.uvs.insert(mesh.uvs.end(), {{0, 0}, {1, 0}, {1, 1}});
  }
}

/// Gives a mesh in the world the coordinates that the mapping says. Between the vertices they are
/// linear: right of a plane, near of a sphere or a cylinder whose triangles are small.
void map_vertices(Mesh& mesh, const TextureMapping& mapping) {
  if (mapping.is_uv()) return;
  const bool has_seam = mapping.kind != MappingKind::planar;
  if (has_seam) mesh = split_mesh(mesh);
  mesh.uvs.clear();
  mesh.uvs.reserve(mesh.positions.size());
  for (const Vec3& p : mesh.positions) mesh.uvs.push_back(mapping.at(p));
  if (!has_seam) return;
  for (const TriangleIndices& t : mesh.triangles) close_seam(mesh, t, mapping);
}

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

/// The group of the shapes that move together, from place to place.
class MovingGroups {
 public:
  explicit MovingGroups(Context& context) : context_(context) {
    for (const ShapeEntity& shape : context.description.shapes)
      next_ = std::max(next_, shape.group);
    for (const auto& [name, group] : context.description.groups) next_ = std::max(next_, group);
  }

  std::uint32_t group_of(const Entity& entity) {
    std::vector<float> numbers;
    for (const Affine* map : {&entity.to_world, &*entity.end_to_world})
      for (const Vec4& row : map->row) numbers.insert(numbers.end(), {row.x, row.y, row.z, row.w});
    const auto [found, is_new] = groups_.try_emplace(std::move(numbers), next_ + 1);
    if (is_new) {
      ++next_;
      add_moving_instance(context_, next_, entity.to_world, *entity.end_to_world);
    }
    return found->second;
  }

  static void add_moving_instance(Context& context, std::uint32_t group, const Affine& begin,
                                  const Affine& end) {
    SceneData& scene = context.scene;
    const Description& d = context.description;
    scene.motion.instances.push_back(
        {static_cast<std::uint32_t>(scene.instances.size()), {{d.begin_s, begin}, {d.end_s, end}}});
    scene.instances.push_back({group, begin});
  }

 private:
  Context& context_;
  std::uint32_t next_ = 0;
  std::map<std::vector<float>, std::uint32_t> groups_;  ///< by both transformations
};

/// A mesh in the space of the entity. Its material's light is complete then. One that moves stays
/// there, and an instance moves it.
void place_mesh(Context& context, const ShapeEntity& entity, const ShapeMaterial& shape,
                bool is_quadric, Mesh mesh, MovingGroups& moving) {
  const bool moves = entity.shape.end_to_world.has_value();
  const Affine to_world = moves ? Affine() : entity.shape.to_world;
  if (mesh.uvs.empty() && shape.textured && shape.mapping.is_uv()) add_default_uvs(mesh);
  transform_mesh(mesh, to_world);
  if (shape.textured) {
    TextureMapping mapping = shape.mapping;
    if (moves) mapping.to_texture = mapping.to_texture * entity.shape.to_world;
    map_vertices(mesh, mapping);
  }
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
  double area = 0;
  if (moves && shape.power > 0.0f) {
    Mesh placed = mesh;
    transform_mesh(placed, entity.shape.to_world);
    area = area_of(placed);
  } else {
    area = area_of(mesh);
  }
  set_power(context, entity, shape, area, parts, material);
  mesh.material = context.add_material(material);
  mesh.group = moves ? moving.group_of(entity.shape) : entity.group;
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

/// A whole sphere around the entity's origin, where ours can be as pbrt's: unless it is squeezed,
/// grows while it moves, is repeated, masked, textured by its points, or a lamp that shows a
/// picture or shines inward. Tells whether.
bool place_sphere(Context& context, const ShapeEntity& entity, const ShapeMaterial& shape,
                  float radius) {
  const Affine& to_world = entity.shape.to_world;
  const std::optional<float> factor = uniform_scale(to_world);
  const bool inside_out = turns(entity, true, shape.emits);
  const std::optional<Affine>& end = entity.shape.end_to_world;
  const std::optional<float> end_factor = end ? uniform_scale(*end) : factor;
  if (!factor || !end_factor || std::abs(*end_factor - *factor) > 1e-4f * *factor ||
      entity.group != 0 || (shape.textured && !shape.mapping.is_uv()) ||
      !shape.material.opacity.is_opaque() || shape.material.emission.texture != no_texture ||
      (shape.emits && (inside_out || shape.two_sided))) {
    return false;
  }
  MaterialDescription material = shape.material;
  const double size = double{*factor} * double{radius};
  set_power(context, entity, shape, 4 * double{pi} * size * size, 1, material);
  const std::uint32_t number = context.add_material(material);
  const Vec3 center = to_world.translation();
  if (end) {
    const Description& d = context.description;
    context.scene.motion.spheres.push_back(
        {static_cast<std::uint32_t>(context.scene.spheres.size()),
         {{d.begin_s, to_world}, {d.end_s, *end}}});
  }
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

struct Kind {
  MeshReader read;
  bool is_quadric = false;
};

const std::map<std::string_view, Kind>& kinds() {
  static const std::map<std::string_view, Kind> table = {
      {"trianglemesh", {read_triangle_mesh}}, {"plymesh", {read_ply_mesh}},
      {"bilinearmesh", {read_bilinear_mesh}}, {"loopsubdiv", {read_loop_mesh}},
      {"sphere", {read_sphere, true}},        {"disk", {read_disk, true}},
      {"cylinder", {read_cylinder, true}},    {"curve", {read_curve}},
  };
  return table;
}

void add_shape(Context& context, const ShapeEntity& entity, ShapeMaterials& materials,
               MovingGroups& moving) {
  const std::string& type = entity.shape.type;
  const Parameters& parameters = entity.shape.parameters;
  const auto kind = kinds().find(type);
  if (kind == kinds().end()) {
    return context.reporter.warn_once(
        "shape " + type, parameters.place(),
        "shape '{}' is not supported: it is left out; expected trianglemesh, plymesh, "
        "bilinearmesh, loopsubdiv, sphere, disk, cylinder or curve",
        type);
  }
  const ShapeMaterial material = materials.read(entity);
  if (material.invisible) {
    return context.reporter.warn_once(
        "invisible", parameters.place(),
        "a shape that light passes (material 'interface', or an alpha of 0) is left out");
  }
  const Entity& placed = entity.shape;
  if (!is_invertible(placed.to_world) ||
      (placed.end_to_world && !is_invertible(*placed.end_to_world))) {
    fail(parameters.place(), "{}: its transformation has no inverse", parameters.what());
  }
  const std::optional<float> radius =
      type == "sphere" ? whole_sphere(entity.shape) : std::optional<float>();
  if (!radius || !place_sphere(context, entity, material, *radius)) {
    Mesh mesh = kind->second.read(context, entity.shape, material);
    if (mesh.triangles.empty()) {
      context.reporter.warn_once("empty mesh", parameters.place(),
                                 "a mesh without triangles is left out");
    } else {
      place_mesh(context, entity, material, kind->second.is_quadric, std::move(mesh), moving);
    }
  }
  parameters.report_unused(context.reporter);
}

/// An instance of an object that has anything.
void add_instance(Context& context, const InstanceEntity& instance,
                  const std::set<std::uint32_t>& groups) {
  const auto group = context.description.groups.find(instance.name);
  if (group == context.description.groups.end()) {
    fail(instance.place, "there is no object '{}'; expected one that ObjectBegin defines",
         instance.name);
  }
  const std::optional<Affine>& end = instance.end_to_world;
  if (!is_invertible(instance.to_world) || (end && !is_invertible(*end))) {
    fail(instance.place, "ObjectInstance: its transformation has no inverse");
  }
  const std::uint32_t number = instance.group != 0 ? instance.group : group->second;
  if (!groups.contains(number)) return;
  if (end) return MovingGroups::add_moving_instance(context, number, instance.to_world, *end);
  context.scene.instances.push_back({number, instance.to_world});
}

}  // namespace

void add_shapes(Context& context) {
  ShapeMaterials materials(context);
  MovingGroups moving(context);
  for (const ShapeEntity& shape : context.description.shapes) {
    context.reporter.attempt(shape.shape.parameters.what(), "is left out",
                             [&] { add_shape(context, shape, materials, moving); });
  }
  std::set<std::uint32_t> groups;
  for (const Mesh& mesh : context.scene.meshes) groups.insert(mesh.group);
  for (const InstanceEntity& instance : context.description.instances) {
    context.reporter.attempt("the instance", "is left out",
                             [&] { add_instance(context, instance, groups); });
  }
}

}  // namespace pt::pbrt
