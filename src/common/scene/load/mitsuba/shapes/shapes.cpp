#include "common/scene/load/mitsuba/shapes/shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "common/scene/load/mitsuba/shapes/shape_kinds.h"

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

/// The group that a shapegroup becomes where an instance first asks for it.
std::uint32_t group_of(Context& context, const Object& shapegroup) {
  const auto group_index = static_cast<std::uint32_t>(context.groups.size() + 1);
  const auto [entry, is_new] = context.groups.try_emplace(&shapegroup, group_index);
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
  const std::uint32_t group_index = group_of(context, *shapegroup);
  const auto is_of_group = [&](const Mesh& mesh) { return mesh.group == group_index; };
  if (std::ranges::any_of(context.scene.meshes, is_of_group)) {
    context.scene.instances.push_back({group_index, to_world});
  }
}

/// Whether shading asks where on the surface a point lies.
bool is_textured(const SceneData& scene, std::uint32_t material_index) {
  const MaterialDescription& material = scene.materials[material_index];
  if (material.is_textured() || uses_tangent(material)) return true;
  return material.node != MaterialNode::none &&
         (is_textured(scene, material.children[0]) || is_textured(scene, material.children[1]));
}

/// Whether it asks in which directions texture coordinates grow.
bool needs_tangents(const SceneData& scene, std::uint32_t material_index) {
  const MaterialDescription& material = scene.materials[material_index];
  if (material.node == MaterialNode::none) return uses_tangent(material);
  return material.node >= MaterialNode::normal_map || needs_tangents(scene, material.children[0]) ||
         needs_tangents(scene, material.children[1]);
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
  adder->second(context, shape,
                {group, *material, is_textured(context.scene, *material),
                 needs_tangents(context.scene, *material), needs_mesh(context, *material)});
}

}  // namespace pt::mitsuba
