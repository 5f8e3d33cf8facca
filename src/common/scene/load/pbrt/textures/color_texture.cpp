#include "common/scene/load/pbrt/textures/color_texture.h"

#include <fmt/format.h>

#include <utility>

#include "common/scene/load/pbrt/textures/texture_kinds.h"

namespace pt::pbrt {
namespace {

using Reader = ColorTexture (*)(Context&, const Entity&, const TextureUse&);

const std::map<std::string_view, Reader>& readers() {
  static const std::map<std::string_view, Reader> table = {
      {"imagemap", read_image_map}, {"constant", read_constant},
      {"scale", read_scale},        {"mix", read_mix},
      {"directionmix", read_mix},   {"checkerboard", read_checkerboard}};
  return table;
}

ColorTexture read_entity(Context& context, const Entity& entity, const TextureUse& use) {
  const OpenEntity open(context, entity);
  const Parameters& parameters = entity.parameters;
  const auto reader = readers().find(entity.type);
  if (reader != readers().end()) {
    const ColorTexture result = reader->second(context, entity, use);
    parameters.report_unused(context.reporter);
    return result;
  }
  context.reporter.warn_once("texture " + entity.type, parameters.place(),
                             fmt::format("texture '{}' is not supported: 0.5 is used; expected "
                                         "imagemap, constant, scale, mix or checkerboard",
                                         entity.type));
  return {Color(0.5f)};
}

/// Once for each use; with the mappings of all that it is made of.
ColorTexture read_once(Context& context, const Entity& entity, const TextureUse& use) {
  const Color& s = use.stand_in;
  const TextureKey key{&entity, use.is_number, static_cast<int>(use.quantity), s.x, s.y, s.z};
  std::shared_ptr<const ReadTexture>& known = context.read_textures[key];
  if (!known) {
    const std::vector<TextureMapping> before = std::exchange(context.mappings, {});
    const ColorTexture value = read_entity(context, entity, use);
    known = std::make_shared<const ReadTexture>(ReadTexture{value, context.mappings});
    context.mappings = before;
  }
  for (const TextureMapping& mapping : known->mappings) context.add_mapping(mapping);
  return known->value;
}

ColorTexture named_texture(Context& context, const Parameter& parameter, const TextureUse& use) {
  if (parameter.strings.size() != 1) fail(parameter.place, "expected the name of one texture");
  const std::string& name = parameter.strings[0];
  const Description& description = context.description;
  const auto& textures = use.is_number ? description.float_textures : description.spectrum_textures;
  auto found = textures.find(name);
  // Of the other type there may be a newer one of that name.
  if (found == textures.end()) found = textures.find(name.substr(0, name.find(newest_mark)));
  if (found != textures.end()) return read_once(context, *found->second, use);
  fail(parameter.place,
       fmt::format("there is no {} texture '{}'", use.is_number ? "float" : "spectrum",
                   name.substr(0, name.find(newest_mark))));
}

ColorTexture read(Context& context, const Parameters& parameters, std::string_view name,
                  const Color& fallback, const TextureUse& use) {
  ColorTexture value{fallback};
  TextureUse own = use;
  own.stand_in = fallback;
  context.reporter.attempt(
      fmt::format("'{}' of {}", name, parameters.what()), "is as if it was not given", [&] {
        if (parameters.has(name, "texture")) {
          value = named_texture(context, *parameters.find(name), own);
        } else if (use.is_number) {
          value.color = Color(parameters.number(name, fallback.x));
        } else {
          value.color = read_color(context, parameters, name, fallback, use.quantity);
        }
      });
  return value;
}

}  // namespace

ColorTexture read_part(Context& context, const Parameters& parameters, std::string_view name,
                       float fallback, const TextureUse& use) {
  return read(context, parameters, name, Color(fallback), use);
}

ColorTexture read_color_texture(Context& context, const Parameters& parameters,
                                std::string_view name, const Color& fallback, Quantity quantity) {
  return read(context, parameters, name, fallback, {false, quantity});
}

ColorTexture read_number_texture(Context& context, const Parameters& parameters,
                                 std::string_view name, float fallback) {
  return read(context, parameters, name, Color(fallback), {true, Quantity::unbounded});
}

float read_plain_number(Context& context, const Parameters& parameters, std::string_view name,
                        float fallback) {
  const ColorTexture value = read_number_texture(context, parameters, name, fallback);
  if (!value.is_constant()) {
    context.reporter.warn_once(
        fmt::format("textured {}", name), parameters.find(name)->place,
        fmt::format("a texture as '{}' is not supported: {} is used", name, fallback));
    return fallback;
  }
  return value.color.x;
}

pt::Parameter parameter_of(const ColorTexture& value) { return {value.color, value.texture}; }

}  // namespace pt::pbrt
