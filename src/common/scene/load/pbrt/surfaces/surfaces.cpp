#include "common/scene/load/pbrt/surfaces/surfaces.h"

#include <fmt/format.h>

#include "common/scene/load/pbrt/surfaces/surface_kinds.h"

namespace pt::pbrt {
namespace {

const std::map<std::string_view, Reader>& readers() {
  static const std::map<std::string_view, Reader> table = {
      {"diffuse", read_diffuse},
      {"coateddiffuse", read_coated_diffuse},
      {"diffusetransmission", read_diffuse_transmission},
      {"conductor", read_conductor},
      {"coatedconductor", read_coated_conductor},
      {"dielectric", read_dielectric},
      {"thindielectric", read_thin_dielectric},
      {"subsurface", read_subsurface},
      {"hair", read_hair},
      {"measured", read_measured},
      {"mix", read_mix_material},
      {"interface", read_interface},
      {"none", read_interface},
      {"", read_interface},
  };
  return table;
}

Surface default_surface() {
  Surface surface;
  surface.material = make_diffuse(Color(0.5f));
  return surface;
}

/// A surface whose normal a map turns: neither shadowed nor flipped (see MaterialNode::normal_map).
Surface mapped(Context& context, MaterialNode node, float scale, std::uint32_t map,
               Surface inside) {
  Surface result;
  result.material = make_mapped(node, {{scale, 1.0f, 1.0f}, map}, 0);
  std::swap(result.material.opacity, inside.material.opacity);
  result.material.children[0] = result.material.children[1] = context.add_material(inside.material);
  return result;
}

/// Under the map of heights or of normals that a material names; pbrt prefers the former.
Surface with_map(Context& context, const Parameters& parameters, const Surface& inside) {
  const Parameter* filename = parameters.find("normalmap", {"string"});
  if (const Parameter* heights = parameters.find("displacement")) {
    const ColorTexture value = read_number_texture(context, parameters, "displacement", 0.0f);
    if (inside.invisible || value.is_constant()) return inside;
    if (context.scene.textures[value.texture].kind == TextureKind::image) {
      return mapped(context, MaterialNode::bump_map, value.color.x, value.texture, inside);
    }
    context.reporter.warn_once("displacement", heights->place,
                               "a 'displacement' of a material that is no picture is not supported "
                               "and ignored");
    return inside;
  }
  if (!filename || inside.invisible) return inside;
  Texture look;
  look.format = TextureFormat::linear8;
  try {
    const auto path = context.resolve(filename->place, parameters.text("normalmap", ""));
    return mapped(context, MaterialNode::normal_map, 1.0f, context.textures.add_file(path, look),
                  inside);
  } catch (const Error& error) {
    fail(filename->place, error.what());
  }
}

Surface read_entity(Context& context, const Entity& entity, const std::string& type) {
  const OpenEntity open(context, entity);
  const Parameters& parameters = entity.parameters;
  const auto reader = readers().find(type);
  if (reader == readers().end()) {
    parameters.ignore_all();
    context.reporter.warn_once("material " + type, parameters.place(),
                               fmt::format("material '{}' is not known: diffuse grey is used; "
                                           "expected diffuse, coateddiffuse, conductor, "
                                           "dielectric, mix, ...",
                                           type));
    return default_surface();
  }
  Surface surface = reader->second(context, parameters);
  surface = with_map(context, parameters, surface);
  parameters.report_unused(context.reporter);
  return surface;
}

}  // namespace

void report_replaced(Context& context, const Parameters& parameters, std::string_view by) {
  context.reporter.warn_once(parameters.what(), parameters.place(),
                             fmt::format("{} is not supported: {}", parameters.what(), by));
}

Surface read_surface(Context& context, const MaterialReference& reference, const Place& place) {
  if (const auto* pointer = std::get_if<EntityPointer>(&reference)) {
    return *pointer ? read_entity(context, **pointer, (*pointer)->type) : default_surface();
  }
  const std::string& name = std::get<std::string>(reference);
  const auto found = context.description.materials.find(name);
  if (found == context.description.materials.end()) {
    fail(place,
         fmt::format("there is no material '{}'; expected one that MakeNamedMaterial defines",
                     name));
  }
  const Parameters& parameters = found->second->parameters;
  const Parameter* type = parameters.find("type", {"string"});
  if (!type) fail(parameters.place(), fmt::format("material '{}' has no 'string type'", name));
  return read_entity(context, *found->second, parameters.text("type", ""));
}

Surface read_interface(Context&, const Parameters&) {
  Surface surface = default_surface();
  surface.material.opacity = constant_opacity(0.0f);
  surface.invisible = true;
  return surface;
}

}  // namespace pt::pbrt
