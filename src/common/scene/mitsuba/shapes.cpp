#include "common/scene/mitsuba/shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/files/mesh_files.h"
#include "common/math/frame.h"
#include "common/scene/mitsuba/box_faces.h"
#include "common/scene/mitsuba/place_mesh.h"
#include "common/scene/mitsuba/tessellate.h"

namespace pt::mitsuba {
namespace {

/// Where a shape goes and what it is made of.
struct Target {
  std::uint32_t group;
  std::uint32_t material;
  bool textured;

  /// Quads and spheres: in the world, without texture coordinates.
  bool analytic() const { return group == 0 && !textured; }
};

bool flips(const Object& shape) { return shape.boolean("flip_normals", false); }

void add_mesh(Context& context, const Object& shape, const Target& target, Mesh mesh,
              const Affine& to_world) {
  const bool face_normals = shape.boolean("face_normals", false);
  if (mesh.triangles.empty()) {
    context.warn_once("empty mesh", shape.element(), "a mesh without triangles is left out");
    return;
  }
  place_mesh(mesh, to_world, face_normals, flips(shape));
  mesh.material = target.material;
  mesh.group = target.group;
  context.scene.meshes.push_back(std::move(mesh));
}

void add_file(Context& context, const Object& shape, const Target& target) {
  const Element* filename = shape.find("filename");
  if (!filename) fail(shape.element(), fmt::format("shape '{}' has no filename", shape.type()));
  const auto path = context.resolve(*filename, filename->required("value"));
  MeshFileOptions options;
  options.face_normals = shape.boolean("face_normals", false);
  options.flip_v = !shape.boolean("flip_tex_coords", shape.type() == "obj");
  const int index = shape.integer("shape_index").value_or(0);
  const Affine to_world = shape.transform("to_world");
  try {
    Mesh mesh = shape.type() == "obj"   ? read_obj(path, options)
                : shape.type() == "ply" ? read_ply(path, options)
                                        : read_serialized(path, index, options);
    add_mesh(context, shape, target, std::move(mesh), to_world);
  } catch (const Error& error) {
    fail(*filename, error.what());
  }
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
  return flips(shape) != (to_world.determinant() < 0.0f);
}

void add_rectangle(Context& context, const Object& shape, const Target& target) {
  const Affine to_world = shape.transform("to_world");
  if (!target.analytic()) {
    return add_mesh(context, shape, target, tessellate_rectangle(), to_world);
  }
  add_quad(context, rectangle_face(), to_world, turns_edges(shape, to_world), target.material);
}

void add_cube(Context& context, const Object& shape, const Target& target) {
  const Affine to_world = shape.transform("to_world");
  if (!target.analytic()) {
    return add_mesh(context, shape, target, tessellate_cube(), to_world);
  }
  for (const BoxFace& face : cube_faces()) {
    add_quad(context, face, to_world, turns_edges(shape, to_world), target.material);
  }
}

/// The scale of a map that keeps angles, or none.
std::optional<float> uniform_scale(const Affine& map) {
  const Vec3 columns[3] = {map.vector({1, 0, 0}), map.vector({0, 1, 0}), map.vector({0, 0, 1})};
  const float scale = glm::length(columns[0]);
  for (int i = 0; i < 3; ++i) {
    const Vec3& next = columns[(i + 1) % 3];
    if (std::abs(glm::dot(columns[i], next)) > 1e-4f * scale * scale) return std::nullopt;
    if (std::abs(glm::length(next) - scale) > 1e-4f * scale) return std::nullopt;
  }
  return scale;
}

float positive(const Object& shape, std::string_view name, float fallback) {
  const float value = shape.number(name, fallback);
  if (!(value > 0.0f)) {
    fail(shape.element(), fmt::format("{} of {} '{}' is {}; expected a length above 0", name,
                                      shape.tag(), shape.type(), value));
  }
  return value;
}

void add_sphere(Context& context, const Object& shape, const Target& target) {
  const Vec3 center = shape.vector("center", Vec3(0.0f));
  const float radius = positive(shape, "radius", 1.0f);
  const Affine to_world = shape.transform("to_world");
  const std::optional<float> factor = uniform_scale(to_world);
  const bool inside_out = turns_edges(shape, to_world);  // as Mitsuba 3 has it for spheres
  if (factor && target.analytic() && !inside_out) {
    context.scene.add_sphere(to_world.point(center), *factor * radius, target.material);
    return;
  }
  context.warn_once("sphere mesh", shape.element(),
                    "a sphere that is textured, turned inside out, squeezed or repeated: "
                    "triangles are used");
  const Affine placed = to_world * translate(center) * scale(Vec3(radius));
  Mesh mesh = tessellate_sphere();
  // place_mesh keeps normals outward when mirrored; Mitsuba's spheres do not.
  if (to_world.determinant() < 0.0f) {
    for (Vec3& normal : mesh.normals) normal = -normal;
  }
  add_mesh(context, shape, target, std::move(mesh), placed);
}

void add_disk(Context& context, const Object& shape, const Target& target) {
  add_mesh(context, shape, target, tessellate_disk(), shape.transform("to_world"));
}

void add_cylinder(Context& context, const Object& shape, const Target& target) {
  const Vec3 p0 = shape.vector("p0", Vec3(0.0f));
  const Vec3 axis = shape.vector("p1", Vec3(0, 0, 1)) - p0;
  const float length = glm::length(axis);
  const float radius = positive(shape, "radius", 1.0f);
  if (!(length > 0.0f)) fail(shape.element(), "cylinder: p0 and p1 are the same point");
  const Frame frame = make_frame(axis / length);
  Affine place;
  for (int i = 0; i < 3; ++i) {
    place.row[i] = {radius * frame.tangent[i], radius * frame.bitangent[i],
                    length * frame.normal[i], p0[i]};
  }
  add_mesh(context, shape, target, tessellate_cylinder(), shape.transform("to_world") * place);
}

using Adder = void (*)(Context&, const Object&, const Target&);

const std::map<std::string_view, Adder>& adders() {
  static const std::map<std::string_view, Adder> table = {
      {"obj", add_file},      {"ply", add_file},          {"serialized", add_file},
      {"sphere", add_sphere}, {"cube", add_cube},         {"rectangle", add_rectangle},
      {"disk", add_disk},     {"cylinder", add_cylinder},
  };
  return table;
}

/// The group that a shapegroup becomes where an instance first asks for it.
std::uint32_t group_of(Context& context, const Object& shapegroup) {
  const auto number = static_cast<std::uint32_t>(context.groups.size() + 1);
  const auto [entry, is_new] = context.groups.try_emplace(&shapegroup, number);
  const std::uint32_t group = entry->second;
  if (is_new) {
    for (const Object* shape : shapegroup.children("shape")) add_shape(context, *shape, group);
  }
  return group;
}

void add_instance(Context& context, const Object& shape, std::uint32_t group) {
  if (group != 0) {
    context.warn_once("nested instance", shape.element(),
                      "an instance in a shapegroup is not supported: it is left out");
    return;
  }
  const Object* shapegroup = shape.child("shape");
  if (!shapegroup || shapegroup->type() != "shapegroup") {
    fail(shape.element(), "instance: expected a <ref> to a shape of type 'shapegroup'");
  }
  const Affine to_world = shape.transform("to_world");
  const std::uint32_t number = group_of(context, *shapegroup);
  const auto is_of_group = [&](const Mesh& mesh) { return mesh.group == number; };
  if (std::ranges::any_of(context.scene.meshes, is_of_group)) {
    context.scene.instances.push_back({number, to_world});
  }
}

bool is_textured(const SceneData& scene, std::uint32_t material) {
  return scene.materials[material].textures != 0;
}

}  // namespace

void add_shape(Context& context, const Object& shape, std::uint32_t group) {
  const std::string type = shape.type();
  if (type == "shapegroup") return;  // loaded when an instance asks for it
  if (type == "instance") return add_instance(context, shape, group);
  if (type == "merge") {
    for (const Object* nested : shape.children("shape")) add_shape(context, *nested, group);
    return;
  }
  const auto adder = adders().find(type);
  if (adder == adders().end()) {
    context.warn_once("shape " + type, shape.element(),
                      fmt::format("shape '{}' is not supported: it is left out", type));
    return;
  }
  const std::optional<std::uint32_t> material = material_of(context, shape, group);
  if (!material) return shape.ignore_all();
  adder->second(context, shape, {group, *material, is_textured(context.scene, *material)});
}

}  // namespace pt::mitsuba
