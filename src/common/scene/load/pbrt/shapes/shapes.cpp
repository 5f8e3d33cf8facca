#include "common/scene/load/pbrt/shapes/shapes.h"

#include <fmt/format.h>

#include <set>

#include "common/scene/load/pbrt/description/transforms.h"
#include "common/scene/load/pbrt/shapes/place_shape.h"
#include "common/scene/load/pbrt/shapes/shape_kinds.h"

namespace pt::pbrt {
namespace {

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

void add_shape(Context& context, const ShapeEntity& entity, ShapeMaterials& materials) {
  const std::string& type = entity.shape.type;
  const Parameters& parameters = entity.shape.parameters;
  const auto kind = kinds().find(type);
  if (kind == kinds().end()) {
    return context.reporter.warn_once(
        "shape " + type, parameters.place(),
        fmt::format("shape '{}' is not supported: it is left out; expected trianglemesh, plymesh, "
                    "bilinearmesh, loopsubdiv, sphere, disk, cylinder or curve",
                    type));
  }
  const ShapeMaterial material = materials.read(entity);
  if (material.invisible) {
    return context.reporter.warn_once("invisible", parameters.place(),
                                      "a shape that light passes (material 'interface', or an "
                                      "alpha of 0) is left out");
  }
  if (!is_invertible(entity.shape.to_world)) {
    fail(parameters.place(),
         fmt::format("{}: its transformation has no inverse", parameters.what()));
  }
  const std::optional<float> radius =
      type == "sphere" ? whole_sphere(entity.shape) : std::optional<float>();
  if (!radius || !place_sphere(context, entity, material, *radius)) {
    Mesh mesh = kind->second.read(context, entity.shape, material);
    if (mesh.triangles.empty()) {
      context.reporter.warn_once("empty mesh", parameters.place(),
                                 "a mesh without triangles is left out");
    } else {
      place_mesh(context, entity, material, kind->second.is_quadric, std::move(mesh));
    }
  }
  parameters.report_unused(context.reporter);
}

/// An instance of an object that has anything.
void add_instance(Context& context, const InstanceEntity& instance,
                  const std::set<std::uint32_t>& groups) {
  const auto group = context.description.groups.find(instance.name);
  if (group == context.description.groups.end()) {
    fail(instance.place, fmt::format("there is no object '{}'; expected one that ObjectBegin "
                                     "defines",
                                     instance.name));
  }
  if (!is_invertible(instance.to_world)) {
    fail(instance.place, "ObjectInstance: its transformation has no inverse");
  }
  const std::uint32_t number = instance.group != 0 ? instance.group : group->second;
  if (groups.contains(number)) context.scene.instances.push_back({number, instance.to_world});
}

}  // namespace

void add_shapes(Context& context) {
  ShapeMaterials materials(context);
  for (const ShapeEntity& shape : context.description.shapes) {
    context.reporter.attempt(shape.shape.parameters.what(), "is left out",
                             [&] { add_shape(context, shape, materials); });
  }
  std::set<std::uint32_t> groups;
  for (const Mesh& mesh : context.scene.meshes) groups.insert(mesh.group);
  for (const InstanceEntity& instance : context.description.instances) {
    context.reporter.attempt("the instance", "is left out",
                             [&] { add_instance(context, instance, groups); });
  }
}

}  // namespace pt::pbrt
