// Textures made of others, and how all lie on surfaces.
#include <fmt/format.h>

#include "common/scene/load/pbrt/description/transforms.h"
#include "common/scene/load/pbrt/textures/bake.h"
#include "common/scene/load/pbrt/textures/texture_kinds.h"

namespace pt::pbrt {

namespace {

TextureMapping mapping_by_points(const Entity& entity, MappingKind kind) {
  const Parameters& parameters = entity.parameters;
  TextureMapping mapping;
  mapping.kind = kind;
  if (!is_invertible(entity.to_world)) {
    fail(parameters.place(),
         fmt::format("{}: its transformation has no inverse", parameters.what()));
  }
  mapping.to_texture = inverse(entity.to_world);
  if (kind != MappingKind::planar) return mapping;
  mapping.u_axis = parameters.point("v1", mapping.u_axis);
  mapping.v_axis = parameters.point("v2", mapping.v_axis);
  mapping.shift = {parameters.number("udelta", 0.0f), parameters.number("vdelta", 0.0f)};
  return mapping;
}

}  // namespace

void read_mapping(Context& context, const Entity& entity, Texture& texture) {
  const Parameters& parameters = entity.parameters;
  static const std::map<std::string_view, MappingKind> kinds = {
      {"uv", MappingKind::uv},
      {"planar", MappingKind::planar},
      {"spherical", MappingKind::spherical},
      {"cylindrical", MappingKind::cylindrical}};
  const std::string name = parameters.text("mapping", "uv");
  const auto kind = kinds.find(name);
  if (kind == kinds.end()) {
    context.reporter.warn_once("mapping " + name, parameters.place(),
                               fmt::format("mapping '{}' is not known: uv is used; expected uv, "
                                           "planar, spherical or cylindrical",
                                           name));
  }
  if (kind != kinds.end() && kind->second != MappingKind::uv) {
    context.add_mapping(mapping_by_points(entity, kind->second));
    return;
  }
  context.add_mapping({});
  texture.u_row[0] = parameters.number("uscale", 1.0f);
  texture.v_row[1] = parameters.number("vscale", 1.0f);
  texture.u_row[2] = parameters.number("udelta", 0.0f);
  texture.v_row[2] = parameters.number("vdelta", 0.0f);
}

ColorTexture read_constant(Context& context, const Entity& entity, const TextureUse& use) {
  return read_part(context, entity.parameters, "value", 1.0f, use);
}

/// pbrt-v3 multiplies two of the same kind.
ColorTexture read_scale(Context& context, const Entity& entity, const TextureUse& use) {
  const Parameters& parameters = entity.parameters;
  const bool is_earlier = parameters.find("tex1") || parameters.find("tex2");
  const ColorTexture value = read_part(context, parameters, is_earlier ? "tex1" : "tex", 1.0f, use);
  const ColorTexture by = is_earlier ? read_part(context, parameters, "tex2", 1.0f, use)
                                     : read_number_texture(context, parameters, "scale", 1.0f);
  if (by.is_constant()) return {value.color * by.color, value.texture};
  if (value.is_constant()) return {value.color * by.color, by.texture};
  return bake(context, {value, by}, [](const auto& v) { return v[0] * v[1]; });
}

/// `directionmix` is between two directions; we take what lies in the middle.
ColorTexture read_mix(Context& context, const Entity& entity, const TextureUse& use) {
  const Parameters& parameters = entity.parameters;
  const ColorTexture first = read_part(context, parameters, "tex1", 0.0f, use);
  const ColorTexture second = read_part(context, parameters, "tex2", 1.0f, use);
  ColorTexture amount{Color(0.5f)};
  if (entity.type == "mix") {
    amount = read_number_texture(context, parameters, "amount", 0.5f);
  } else {
    parameters.ignore({"dir"});
    context.reporter.warn_once("directionmix", parameters.place(),
                               "texture 'directionmix' is not supported: an even mix is used");
  }
  return bake(context, {first, second, amount}, [](const auto& v) {
    const float t = glm::clamp(v[2].x, 0.0f, 1.0f);
    return (1.0f - t) * v[0] + t * v[1];
  });
}

/// pbrt's squares have edges of 1 in the texture's coordinates, ours of half a unit.
ColorTexture read_checkerboard(Context& context, const Entity& entity, const TextureUse& use) {
  const Parameters& parameters = entity.parameters;
  if (parameters.integer("dimension", 2) != 2) {
    context.reporter.warn_once("checkerboard 3", parameters.place(),
                               "a checkerboard of dimension 3 is not supported: one of (u, v) is "
                               "used");
  }
  const ColorTexture first = read_part(context, parameters, "tex1", 1.0f, use);
  const ColorTexture second = read_part(context, parameters, "tex2", 0.0f, use);
  parameters.ignore({"aamode"});  // of pbrt-v3
  Texture texture;
  read_mapping(context, entity, texture);
  for (int i = 0; i < 3; ++i) texture.u_row[i] *= 0.5f, texture.v_row[i] *= 0.5f;
  texture.kind = TextureKind::checkerboard;
  texture.color0 = first.color, texture.color1 = second.color;
  texture.nested[0] = first.texture, texture.nested[1] = second.texture;
  return {Color(1.0f), context.textures.add_plain(texture)};
}

}  // namespace pt::pbrt
