// <shape>s to spheres, quads, meshes and instances.
#include <algorithm>
#include <map>

#include "common/geometry/mesh.h"
#include "common/math/transform.h"
#include "common/scene/load/files/importer.h"
#include "common/scene/load/files/meshes/mesh_files.h"
#include "common/scene/load/files/meshes/vertex_colors.h"
#include "common/scene/load/mitsuba/scene_parts.h"
#include "common/scene/load/mitsuba/surfaces/surfaces.h"
#include "common/scene/load/mitsuba/xml/elements.h"

namespace pt::mitsuba {
namespace {

/// Applies `to_world`, adds normals where there are none unless `face_normals`, turns the surface
/// inside out where `flip_normals`. Then winds each triangle so that its geometric normal is on
/// the side of its vertices' normals: in Mitsuba these decide on which side a surface emits, also
/// where a mirroring transform has turned the winding alone.
void place_mesh(Mesh& mesh, const Affine& to_world, bool face_normals, bool flip_normals) {
  if (face_normals) mesh.normals.clear();
  transform_mesh(mesh, to_world);
  if (mesh.normals.empty() && !face_normals) compute_vertex_normals(mesh);
  if (flip_normals) turn_mesh(mesh);
  if (!mesh.normals.empty()) wind_by_normals(mesh);
}

}  // namespace

// Shapes of triangles: obj, ply, serialized.

void add_mesh(Context& context, const Object& shape, const Target& target, Mesh mesh,
              const Affine& to_world) {
  const bool face_normals = shape.boolean("face_normals", false);
  if (mesh.triangles.empty()) {
    context.warn_once("empty mesh", shape.element(), "a mesh without triangles is left out");
    return;
  }
  place_mesh(mesh, to_world, face_normals, shape.boolean("flip_normals", false));
  mesh.material = target.material;
  mesh.group = target.group;
  SceneData& scene = context.scene;
  if (const std::string id = shape.id(); !id.empty())
    scene.names.meshes[static_cast<std::uint32_t>(scene.meshes.size())] = id;
  scene.meshes.push_back(std::move(mesh));
}

namespace {

MeshFile mesh_file_of(const Object& shape, std::filesystem::path path) {
  using Format = MeshFile::Format;
  const std::string type = shape.type();
  MeshFile file{type == "obj"   ? Format::obj
                : type == "ply" ? Format::ply
                                : Format::serialized,
                std::move(path)};
  file.options.face_normals = shape.boolean("face_normals", false);
  file.options.flip_v = !shape.boolean("flip_tex_coords", type == "obj");
  file.shape_index = shape.integer("shape_index").value_or(0);
  return file;
}

const Element& filename_of(const Object& shape) {
  const Element* filename = shape.find("filename");
  if (!filename) fail(shape.element(), "shape '{}' has no filename", shape.type());
  return *filename;
}

}  // namespace

void add_file(Context& context, const Object& shape, const Target& target) {
  const Element& filename = filename_of(shape);
  const MeshFile file = mesh_file_of(shape, context.resolve(filename, filename.required("value")));
  std::vector<std::string> warnings;
  Mesh mesh;
  try {
    mesh = read_mesh(file, warnings);
  } catch (const Error& error) {
    return context.leave_out(shape, filename, error.what());
  }
  for (const std::string& warning : warnings) {
    context.warn_once(warning, filename, "{}: {}", file.path.string(), warning);
  }
  add_mesh(context, shape, target, std::move(mesh), target.to_world);
}

/// A mesh of LoadOptions::meshes.
void add_memory(Context& context, const Object& shape, const Target& target) {
  const Mesh* mesh = context.memory_mesh(shape);
  if (!mesh) fail(shape.element(), "shape 'mesh': expected vertices and triangles");
  add_mesh(context, shape, target, *mesh, target.to_world);
}

namespace {

// The material of a shape: its bsdf and its emitter.

/// Mitsuba's surface of a shape without a bsdf.
Surface default_surface(const Object* emitter) {
  Surface surface;
  surface.material = make_diffuse(Color(emitter ? 0.0f : 0.5f));
  surface.material.one_sided = true;
  return surface;
}

void add_emission(Context& context, const Object& emitter, Surface& surface) {
  if (emitter.type() != "area") {
    context.warn_once("shape emitter " + emitter.type(), emitter.element(),
                      "emitter '{}' on a shape is not supported: it is left out", emitter.type());
    return context.add_left_out(emitter);
  }
  context.add_lit();
  emitter.ignore({"sampling_weight"});
  const ColorTexture radiance = read_color_texture(
      context, emitter, emission_name(emitter, "radiance"), Color(1.0f), Quantity::emission);
  surface.material.emission = {radiance.color, radiance.texture};
  if (surface.invisible) {
    context.warn_once("invisible emitter", emitter.element(),
                      "an emitter that light passes is not supported: it is black instead");
    surface = default_surface(&emitter);
    surface.material.emission = {radiance.color, radiance.texture};
  }
}

/// By their ids; what has none is its shape's.
void name_material(SceneData& scene, std::uint32_t material, const Object& shape,
                   const Object* bsdf, const Object* emitter) {
  const std::string own = shape.id();
  const auto name_of = [&](const Object* object, const char* part) {
    const std::string id = object ? object->id() : "";
    return !id.empty() || own.empty() ? id : own + part;
  };
  if (const std::string name = name_of(bsdf, ".bsdf"); !name.empty())
    scene.names.materials[material] = name;
  if (!emitter) return;
  if (const std::string name = name_of(emitter, ""); !name.empty())
    scene.names.emitters[material] = name;
}

const Object* emitter_of(Context& context, const Object& shape, std::uint32_t group) {
  const Object* emitter = shape.child("emitter");
  if (!emitter) emitter = shape.child("luminaire");
  if (emitter) context.on_shapes.insert(emitter);
  if (!emitter || group == 0) return emitter;
  context.warn_once("instanced emitter", emitter->element(),
                    "an emitter in a shapegroup is not supported: it is black instead");
  context.add_left_out(*emitter);
  return nullptr;
}

/// The number of the material of a shape's bsdf and emitter, or none where the shape is invisible.
/// What is repeated (in a group but 0) does not emit.
std::optional<std::uint32_t> material_of(Context& context, const Object& shape,
                                         std::uint32_t group) {
  const Object* bsdf = shape.child("bsdf");
  const Object* emitter = emitter_of(context, shape, group);
  const ShapeMedia media = media_of(context, shape);
  const bool has_medium = !shape.children("medium").empty();
  if (has_medium && !media.any && !bsdf && !emitter) return std::nullopt;
  constexpr std::uint32_t invisible = 0xffffffffu;
  const auto [entry, is_new] = context.materials.try_emplace(
      {bsdf, emitter, media.boundary.outside, media.boundary.inside}, invisible);
  if (is_new) {
    Surface surface = bsdf ? read_surface(context, *bsdf) : default_surface(emitter);
    const bool has_nothing = bsdf ? surface.invisible : has_medium && !emitter;
    if (media.any) {
      const bool passes = has_nothing && !emitter;
      if (passes) surface = Surface();
      surface.material.is_boundary = true;
      surface.material.media = media.boundary;
      surface.material.passes = passes;
    }
    if (emitter) add_emission(context, *emitter, surface);
    if (!surface.invisible) {
      entry->second = context.scene.add_material(surface.material);
      name_material(context.scene, entry->second, shape, bsdf, emitter);
    }
  }
  return entry->second == invisible ? std::nullopt : std::optional(entry->second);
}

using ShapeAdder = void (*)(Context&, const Object&, const Target&);

const std::map<std::string_view, ShapeAdder>& shape_adders() {
  static const std::map<std::string_view, ShapeAdder> table = {
      {"obj", add_file},
      {"ply", add_file},
      {"serialized", add_file},
      {"mesh", add_memory},
      {"sphere", add_sphere},
      {"cube", add_cube},
      {"rectangle", add_rectangle},
      {"disk", add_disk},
      {"cylinder", add_cylinder},
  };
  return table;
}

}  // namespace

void read_mesh_ahead(const Context& context, const Object& shape) {
  const auto adder = shape_adders().find(shape.type());
  if (adder == shape_adders().end() || adder->second != add_file) return;
  const Element& filename = filename_of(shape);
  pt::read_mesh_ahead(mesh_file_of(shape, context.find(filename, filename.required("value"))));
}

std::vector<std::string> shape_types() {
  std::vector<std::string> types = {"shapegroup", "instance", "merge"};
  for (const auto& entry : shape_adders()) types.emplace_back(entry.first);
  return types;
}

namespace {

/// The group that a shapegroup becomes where an instance first asks for it; 0 where it is empty.
std::uint32_t group_of(Context& context, const Object& shapegroup) {
  const auto group_index = static_cast<std::uint32_t>(context.groups.size() + 1);
  const auto [entry, is_new] = context.groups.try_emplace(&shapegroup, group_index);
  if (is_new) {
    const std::size_t before = context.scene.meshes.size();
    for (const Object* shape : shapegroup.children("shape")) {
      add_shape(context, *shape, group_index);
    }
    if (context.scene.meshes.size() == before) entry->second = 0;
  }
  return entry->second;
}

/// Where to_world squeezes a shape flat along its z, the nearest map that does not; none where it
/// leaves less than a plane.
std::optional<Affine> unsqueezed(Affine map) {
  const Vec3 x = map.vector({1, 0, 0}), y = map.vector({0, 1, 0});
  const Vec3 normal = glm::cross(x, y);
  const float area = glm::length(normal);
  if (!(area > 1e-6f * glm::length(x) * glm::length(y))) return std::nullopt;
  const Vec3 z = 1e-4f * std::max(glm::length(x), glm::length(y)) / area * normal;
  for (int i = 0; i < 3; ++i) map.row[i].z = z[i];
  return map;
}

/// to_world, which can be inverted; else none, and the shape is left out.
std::optional<Affine> place_of(Context& context, const Object& shape) {
  const Element* at = shape.find_transform("to_world");
  if (!at) return Affine();
  const Affine map = read_transform(*at);
  if (!is_singular(map)) return map;
  if (const std::optional<Affine> flat = unsqueezed(map)) {
    context.warn_once("flat shape", *at,
                      "to_world squeezes a shape flat: it is a ten-thousandth as thick as wide");
    return flat;
  }
  context.leave_out(shape, *at, "<transform> is singular (it flattens the shape)");
  return std::nullopt;
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
  const std::uint32_t group_index = group_of(context, *shapegroup);
  if (group_index != 0) context.scene.instances.push_back({group_index, to_world});
}

bool needs_mesh(const Context& context, std::uint32_t material_index) {
  const MaterialDescription& material = context.scene.materials[material_index];
  return !material.opacity.is_opaque() || material.emission.texture != no_texture ||
         context.colors.are_in(material_index);
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
  const auto adder = shape_adders().find(type);
  if (adder == shape_adders().end()) {
    context.warn_once("shape " + type, shape.element(),
                      "shape '{}' is not supported: it is left out", type);
    return;
  }
  const std::optional<std::uint32_t> material = material_of(context, shape, group);
  if (!material) return shape.ignore_all();
  const std::optional<Affine> to_world = place_of(context, shape);
  if (!to_world) return;
  const MaterialDescription& description = context.scene.materials[*material];
  adder->second(context, shape,
                {*to_world, group, *material, is_textured(context.scene, description),
                 needs_tangents(context.scene, description), needs_mesh(context, *material)});
}

}  // namespace pt::mitsuba
