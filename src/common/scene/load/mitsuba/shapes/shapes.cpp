#include "common/scene/load/mitsuba/shapes/shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "common/scene/load/files/material_parts.h"
#include "common/scene/load/mitsuba/shapes/shape_kinds.h"
#include "common/scene/load/mitsuba/xml/transforms.h"

namespace pt::mitsuba {
namespace {

using Adder = void (*)(Context&, const Object&, const Target&);

const std::map<std::string_view, Adder>& adders() {
  static const std::map<std::string_view, Adder> table = {
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

/// Whether shading asks where on the surface a point lies.
bool is_textured(const SceneData& scene, std::uint32_t material) {
  return any_part(scene, material, [](const MaterialDescription& part) {
    return part.is_textured() || uses_tangent(part);
  });
}

/// Whether it asks in which directions texture coordinates grow.
bool needs_tangents(const SceneData& scene, std::uint32_t material) {
  return any_part(scene, material, [](const MaterialDescription& part) {
    return part.node == MaterialNode::none ? uses_tangent(part)
                                           : part.node >= MaterialNode::normal_map;
  });
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
  const auto adder = adders().find(type);
  if (adder == adders().end()) {
    context.warn_once("shape " + type, shape.element(),
                      fmt::format("shape '{}' is not supported: it is left out", type));
    return;
  }
  const std::optional<std::uint32_t> material = material_of(context, shape, group);
  if (!material) return shape.ignore_all();
  const std::optional<Affine> to_world = place_of(context, shape);
  if (!to_world) return;
  adder->second(context, shape,
                {*to_world, group, *material, is_textured(context.scene, *material),
                 needs_tangents(context.scene, *material), needs_mesh(context, *material)});
}

}  // namespace pt::mitsuba
