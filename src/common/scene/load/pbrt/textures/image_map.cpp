// Pictures as textures.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/scene/load/files/meshes/text_number.h"
#include "common/scene/load/pbrt/textures/bake.h"
#include "common/scene/load/pbrt/textures/texture_kinds.h"

namespace pt::pbrt {
namespace {

TextureWrap read_wrap(Context& context, const Parameters& parameters) {
  const std::string wrap = parameters.text("wrap", "repeat");
  if (wrap == "repeat") return TextureWrap::repeat;
  if (wrap != "clamp") {
    context.reporter.warn_once(
        "wrap " + wrap, parameters.find("wrap")->place,
        fmt::format("wrap '{}' is not supported: clamp is used; expected repeat or clamp", wrap));
  }
  return TextureWrap::clamp;
}

void read_filter(Context& context, const Parameters& parameters, Texture& look) {
  const std::string filter = parameters.text("filter", "bilinear");
  if (filter == "point") look.filter = TextureFilter::nearest;
  // What the others do about aliasing, samples do.
  if (filter != "point" && filter != "bilinear" && filter != "trilinear" && filter != "EWA" &&
      filter != "ewa") {
    context.reporter.warn_once("filter " + filter, parameters.find("filter")->place,
                               fmt::format("filter '{}' is not known: bilinear is used; expected "
                                           "point, bilinear, trilinear or EWA",
                                           filter));
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
  std::string ending = path.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
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
  fail(given->place, fmt::format("encoding '{}'; expected sRGB, linear or 'gamma 2.2'", name));
}

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
  look.format = encoding.is_srgb ? TextureFormat::srgb8 : TextureFormat::linear8;
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
