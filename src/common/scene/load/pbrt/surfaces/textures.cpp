#include "common/scene/load/pbrt/surfaces/textures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/scene/load/files/text.h"
#include "common/scene/load/pbrt/syntax/description.h"

namespace pt::pbrt {
namespace {

using TextureReader = ColorTexture (*)(Context&, const Entity&, const TextureUse&);

const std::map<std::string_view, TextureReader>& texture_readers() {
  static const std::map<std::string_view, TextureReader> table = {
      {"imagemap", read_image_map}, {"constant", read_constant},
      {"scale", read_scale},        {"mix", read_mix},
      {"directionmix", read_mix},   {"checkerboard", read_checkerboard}};
  return table;
}

ColorTexture read_entity(Context& context, const Entity& entity, const TextureUse& use) {
  const OpenEntity open(context, entity);
  const Parameters& parameters = entity.parameters;
  const auto reader = texture_readers().find(entity.type);
  if (reader != texture_readers().end()) {
    const ColorTexture result = reader->second(context, entity, use);
    parameters.report_unused(context.reporter);
    return result;
  }
  context.reporter.warn_once("texture " + entity.type, parameters.place(),
                             "texture '{}' is not supported: 0.5 is used; expected imagemap, "
                             "constant, scale, mix or checkerboard",
                             entity.type);
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
  // A newer texture of that name may have the other type.
  if (found == textures.end()) found = textures.find(name.substr(0, name.find(newest_mark)));
  if (found != textures.end()) return read_once(context, *found->second, use);
  fail(parameter.place, "there is no {} texture '{}'", use.is_number ? "float" : "spectrum",
       name.substr(0, name.find(newest_mark)));
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
    context.reporter.warn_once(fmt::format("textured {}", name), parameters.find(name)->place,
                               "a texture as '{}' is not supported: {} is used", name, fallback);
    return fallback;
  }
  return value.color.x;
}

namespace {

// Textures made of others, and how all lie on surfaces.

TextureMapping mapping_by_points(const Entity& entity, MappingKind kind) {
  const Parameters& parameters = entity.parameters;
  TextureMapping mapping;
  mapping.kind = kind;
  if (!is_invertible(entity.to_world)) {
    fail(parameters.place(), "{}: its transformation has no inverse", parameters.what());
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
    context.reporter.warn_once(
        "mapping " + name, parameters.place(),
        "mapping '{}' is not known: uv is used; expected uv, planar, spherical or cylindrical",
        name);
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
    context.reporter.warn_once(
        "checkerboard 3", parameters.place(),
        "a checkerboard of dimension 3 is not supported: one of (u, v) is used");
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

namespace {

// Pictures as textures.

TextureWrap read_wrap(Context& context, const Parameters& parameters) {
  const std::string wrap = parameters.text("wrap", "repeat");
  if (wrap == "repeat") return TextureWrap::repeat;
  if (wrap != "clamp") {
    context.reporter.warn_once(
        "wrap " + wrap, parameters.find("wrap")->place,
        "wrap '{}' is not supported: clamp is used; expected repeat or clamp", wrap);
  }
  return TextureWrap::clamp;
}

void read_filter(Context& context, const Parameters& parameters, Texture& look) {
  const std::string filter = parameters.text("filter", "bilinear");
  if (filter == "point") look.filter = TextureFilter::nearest;
  // What the others do about aliasing, samples do.
  if (filter != "point" && filter != "bilinear" && filter != "trilinear" && filter != "EWA" &&
      filter != "ewa") {
    context.reporter.warn_once(
        "filter " + filter, parameters.find("filter")->place,
        "filter '{}' is not known: bilinear is used; expected point, bilinear, trilinear or EWA",
        filter);
  }
  parameters.ignore({"maxanisotropy", "trilinear"});
}

/// The curve of a picture's integers: sRGB, or what linear numbers are to be raised to. pbrt asks
/// the file for the encoding of a PNG alone; all else of 8 bits is sRGB.
struct Encoding {
  bool is_srgb = true;
  float gamma = 1.0f;
};

Encoding read_encoding(const Parameters& parameters, const std::filesystem::path& path) {
  // pbrt-v3 says so of all pictures: a curve, or whether there is that of sRGB.
  if (const Parameter* gamma = parameters.find("gamma", {"bool", "float", "integer"})) {
    if (gamma->type == "bool") return {parameters.boolean("gamma", true), 1.0f};
    return {false, parameters.number("gamma", 1.0f)};
  }
  const Parameter* given = parameters.find("encoding", {"string"});
  const std::string ending = lower_case(path.extension().string());
  if (!given || ending != ".png") return {};
  const std::string name = parameters.text("encoding", "sRGB");
  if (name == "sRGB") return {};
  if (name == "linear") return {false, 1.0f};
  std::string_view words = name;
  if (next_word(words) == "gamma") {
    try {
      const double gamma = pt::parse_number(next_word(words));
      if (gamma > 0 && gamma < 100) return {false, static_cast<float>(gamma)};
    } catch (const Error&) {  // said below
    }
  }
  fail(given->place, "encoding '{}'; expected sRGB, linear or 'gamma 2.2'", name);
}

}  // namespace

TextureFormat encoding_of(const Parameters& imagemap, const std::filesystem::path& path) {
  return read_encoding(imagemap, path).is_srgb ? TextureFormat::srgb8 : TextureFormat::linear8;
}

namespace {

ColorTexture add_file(Context& context, const Parameter& filename, const std::string& name,
                      const Texture& look, const TextureUse& use) {
  ColorTexture result{use.stand_in};
  attempt_file(context, filename, "its parameter's default", [&] {
    const auto path = context.resolve(filename.place, name);
    // A number is the alpha of a picture that has one, else the mean of its colours; in pbrt-v3
    // their luminance.
    const bool is_earlier = context.description.is_earlier;
    if (use.is_number && !is_earlier && context.has_alpha(path)) {
      result.texture = context.textures.add_alpha_of(context.textures.add_file(path, look));
    } else {
      std::optional<Color> weights;
      if (use.is_number) {
        weights = is_earlier ? Color(0.212671f, 0.71516f, 0.072169f) : Color(1.0f / 3.0f);
      }
      result.texture = context.textures.add_file(path, look, weights);
    }
    result.color = Color(1.0f);
  });
  return result;
}

}  // namespace

ColorTexture read_image_map(Context& context, const Entity& entity, const TextureUse& use) {
  const Parameters& parameters = entity.parameters;
  const Parameter* filename = parameters.find("filename", {"string"});
  if (!filename) fail(parameters.place(), "texture 'imagemap' has no 'string filename'");
  Texture look;
  const Encoding encoding = read_encoding(parameters, parameters.text("filename", ""));
  look.format = encoding_of(parameters, parameters.text("filename", ""));
  look.wrap_u = look.wrap_v = read_wrap(context, parameters);
  read_filter(context, parameters, look);
  read_mapping(context, entity, look);
  const float scale = parameters.number("scale", 1.0f);
  const bool invert = parameters.boolean("invert", false);
  if (!(scale >= 0.0f)) fail(parameters.place(), "imagemap: expected a scale that is not negative");
  ColorTexture result = add_file(context, *filename, parameters.text("filename", ""), look, use);
  if (result.is_constant()) return result;
  if (encoding.gamma != 1.0f) {
    result = bake(context, {result},
                  [&](const auto& v) { return glm::pow(v[0], Color(encoding.gamma)); });
  }
  result.color = Color(scale);
  if (!invert) return result;
  return bake(context, {result},
              [](const auto& v) { return glm::max(Color(1.0f) - v[0], Color(0.0f)); });
}

}  // namespace pt::pbrt
