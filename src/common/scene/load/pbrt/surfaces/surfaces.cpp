#include "common/scene/load/pbrt/surfaces/surfaces.h"

#include <fmt/format.h>

#include <utility>

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
      {"matte", read_matte},
      {"plastic", read_plastic},
      {"metal", read_metal},
      {"mirror", read_mirror},
      {"glass", read_glass},
      {"uber", read_uber},
      {"substrate", read_substrate},
      {"translucent", read_translucent},
      {"disney", read_disney},
      {"kdsubsurface", read_subsurface_of_color},
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
               const Surface& inside) {
  Surface result;
  result.material =
      under_map(node, {{scale, 1.0f, 1.0f}, map}, inside.material,
                [&](const MaterialDescription& under) { return context.add_material(under); });
  result.keeps_opacity = inside.keeps_opacity;
  return result;
}

/// Under the map of heights or of normals that a material names; pbrt prefers the former.
Surface with_map(Context& context, const Parameters& parameters, const Surface& inside) {
  const Parameter* filename = parameters.find("normalmap", {"string"});
  const char* name = parameters.find("displacement") ? "displacement" : "bumpmap";  // of pbrt-v3
  if (const Parameter* heights = parameters.find(name)) {
    const ColorTexture value = read_number_texture(context, parameters, name, 0.0f);
    if (inside.invisible || value.is_constant()) return inside;
    if (context.scene.textures[value.texture].kind == TextureKind::image) {
      return mapped(context, MaterialNode::bump_map, value.color.x, value.texture, inside);
    }
    context.reporter.warn_once(
        "displacement", heights->place,
        "a 'displacement' of a material that is no picture is not supported and ignored");
    return inside;
  }
  if (!filename || inside.invisible) return inside;
  Texture look;
  look.format = TextureFormat::linear8;
  Surface result = inside;
  attempt_file(context, *filename, "no map of normals", [&] {
    const auto path = context.resolve(filename->place, parameters.text("normalmap", ""));
    result = mapped(context, MaterialNode::normal_map, 1.0f, context.textures.add_file(path, look),
                    inside);
  });
  return result;
}

Surface make_surface(Context& context, const Entity& entity, const std::string& type) {
  const OpenEntity open(context, entity);
  const Parameters& parameters = entity.parameters;
  const auto reader = readers().find(type);
  if (reader == readers().end()) {
    parameters.ignore_all();
    context.reporter.warn_once("material " + type, parameters.place(),
                               "material '{}' is not known: diffuse grey is used; expected "
                               "diffuse, coateddiffuse, conductor, dielectric, mix, ...",
                               type);
    return default_surface();
  }
  Surface surface = reader->second(context, parameters);
  surface = with_map(context, parameters, surface);
  parameters.report_unused(context.reporter);
  return surface;
}

/// Once, however many shapes and mixes name it; with the mappings of its textures.
Surface read_entity(Context& context, const Entity& entity, const std::string& type) {
  const auto known = context.surfaces.find(&entity);
  if (known != context.surfaces.end()) {
    for (const TextureMapping& mapping : known->second->mappings) context.add_mapping(mapping);
    return *known->second;
  }
  const std::vector<TextureMapping> before = std::exchange(context.mappings, {});
  auto surface = std::make_shared<Surface>(make_surface(context, entity, type));
  surface->mappings = std::exchange(context.mappings, before);
  for (const TextureMapping& mapping : surface->mappings) context.add_mapping(mapping);
  context.surfaces.emplace(&entity, surface);
  return *surface;
}

}  // namespace

void report_replaced(Context& context, const Parameters& parameters, std::string_view by) {
  context.reporter.warn_once(fmt::format("replaced {}", by), parameters.place(),
                             "{} is not supported: {}", parameters.what(), by);
}

Surface read_surface(Context& context, const MaterialReference& reference,
                     const FileLocation& place) {
  if (const auto* pointer = std::get_if<EntityPointer>(&reference)) {
    return *pointer ? read_entity(context, **pointer, (*pointer)->type) : default_surface();
  }
  const std::string& name = std::get<std::string>(reference);
  const auto found = context.description.materials.find(name);
  if (found == context.description.materials.end()) {
    fail(place, "there is no material '{}'; expected one that MakeNamedMaterial defines", name);
  }
  const Parameters& parameters = found->second->parameters;
  const Parameter* type = parameters.find("type", {"string"});
  if (!type) fail(parameters.place(), "material '{}' has no 'string type'", name);
  return read_entity(context, *found->second, parameters.text("type", ""));
}

Surface read_interface(Context&, const Parameters&) {
  Surface surface = default_surface();
  surface.material.opacity = constant_opacity(0.0f);
  surface.invisible = true;
  return surface;
}

}  // namespace pt::pbrt
