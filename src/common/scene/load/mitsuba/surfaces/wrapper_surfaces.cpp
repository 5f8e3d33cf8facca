// bsdfs around other ones.
#include <algorithm>

#include "common/scene/load/mitsuba/surfaces/surfaces.h"
#include "common/scene/load/mitsuba/xml/elements.h"

namespace pt::mitsuba {
namespace {

const Object& only_nested(const Object& bsdf) {
  const Object* nested = bsdf.child("bsdf");
  if (!nested) fail(bsdf.element(), "bsdf '{}' has no bsdf inside", bsdf.type());
  return *nested;
}

/// A surface as a part of another one, which takes its opacity.
std::uint32_t add_part(Context& context, Surface& surface) {
  surface.material.opacity = {};
  return context.scene.add_material(surface.material);
}

Surface node_of(const MaterialDescription& node, const Opacity& opacity) {
  Surface surface;
  surface.material = node;
  surface.material.opacity = opacity;
  surface.invisible = opacity.is_constant() && opacity.offset <= 0.0f;
  return surface;
}

/// In Mitsuba a mask inside of both.
void warn_of_masks(Context& context, const Object& bsdf) {
  context.warn_once("masks " + bsdf.type(), bsdf.element(),
                    "opacities that differ inside of bsdf '{}' are not supported: opaque is used",
                    bsdf.type());
}

/// The probability of a blend's second part among what is there, and how much is there.
struct BlendParts {
  Parameter weight;
  Opacity opacity;
};

BlendParts split(Context& context, const Object& bsdf, const ColorTexture& weight,
                 const Opacity& first, const Opacity& second) {
  const Parameter w{Color(weight.color.x), weight.texture};
  if (first.is_opaque() && second.is_opaque()) return {w, {}};
  if (weight.texture == no_texture && first.is_constant() && second.is_constant()) {
    const float a = (1.0f - w.value.x) * first.offset, b = w.value.x * second.offset;
    return {{Color(a + b > 0.0f ? b / (a + b) : 0.0f)}, constant_opacity(a + b)};
  }
  const auto is_null = [](const Opacity& o) { return o.is_constant() && o.offset <= 0.0f; };
  if (is_null(first) && second.is_opaque()) {
    return {{Color(1.0f)}, textured_opacity(w.value.x, w.texture)};
  }
  if (is_null(second) && first.is_opaque()) {
    return {{Color(0.0f)}, {1.0f, -w.value.x, w.texture, 0.0f}};
  }
  warn_of_masks(context, bsdf);
  return {w, {}};
}

Surface blend(Context& context, const Object& bsdf, const ColorTexture& weight, Surface first,
              Surface second) {
  const BlendParts parts =
      split(context, bsdf, weight, first.material.opacity, second.material.opacity);
  if (parts.weight.texture == no_texture && parts.weight.value.x <= 0.0f) {
    return node_of(first.material, parts.opacity);
  }
  if (parts.weight.texture == no_texture && parts.weight.value.x >= 1.0f) {
    return node_of(second.material, parts.opacity);
  }
  const std::uint32_t a = add_part(context, first), b = add_part(context, second);
  return node_of(make_blend(parts.weight, a, b), parts.opacity);
}

Surface two_sided(Context& context, Surface& front, Surface& back) {
  const Opacity opacity = front.material.opacity;
  const std::uint32_t a = add_part(context, front), b = add_part(context, back);
  return node_of(make_two_sided(a, b), opacity);
}

/// One for each bsdf inside, none below 0.
std::vector<float> read_weights(const Object& bsdf, std::size_t count) {
  const Element* element = bsdf.find("weights");
  const std::vector<double> numbers =
      element ? parse_numbers(*element, element->required("value")) : std::vector<double>();
  if (numbers.size() != count || count == 0 ||
      std::ranges::any_of(numbers, [](double w) { return w < 0; })) {
    fail(bsdf.element(),
         "bsdf 'mixturebsdf' has {} weights for {} bsdfs; expected one each, none below 0",
         numbers.size(), count);
  }
  return {numbers.begin(), numbers.end()};
}

bool is_same(const Opacity& a, const Opacity& b) {
  return a.offset == b.offset && a.scale == b.scale && a.texture == b.texture;
}

/// Both masks' product.
Opacity product(Context& context, const Object& bsdf, const Opacity& a, const Opacity& b) {
  if (!a.is_constant() && !b.is_constant()) {
    context.warn_once("mask of a mask", bsdf.element(),
                      "two textures as opacity are not supported: the outer one is used");
    return a;
  }
  const Opacity &constant = a.is_constant() ? a : b, &other = a.is_constant() ? b : a;
  return {constant.offset * other.offset, constant.offset * other.scale, other.texture, 0.0f};
}

/// normalmap and bumpmap: `texture` is the map, and what multiplies it.
Surface read_map(Context& context, const Object& bsdf, MaterialNode node,
                 const ColorTexture& texture, float scale) {
  const bool flips = bsdf.boolean("flip_invalid_normals", true);
  const bool shadows = bsdf.boolean("use_shadowing_function", true);
  Surface inside = read_surface(context, only_nested(bsdf));
  if (texture.texture == no_texture && node == MaterialNode::bump_map) return inside;  // flat
  const Parameter map{{scale, shadows ? 0.0f : 1.0f, flips ? 0.0f : 1.0f}, texture.texture};
  const Opacity opacity = inside.material.opacity;
  return node_of(make_mapped(node, map, add_part(context, inside)), opacity);
}

}  // namespace

Surface read_two_sided(Context& context, const Object& bsdf) {
  const std::vector<const Object*> sides = bsdf.children("bsdf");
  Surface front = read_surface(context, only_nested(bsdf));
  if (sides.size() > 1) {
    Surface back = read_surface(context, *sides[1]);
    if (!is_same(front.material.opacity, back.material.opacity)) warn_of_masks(context, bsdf);
    return two_sided(context, front, back);
  }
  if (front.material.node != MaterialNode::none) return two_sided(context, front, front);
  front.material.one_sided = false;
  return front;
}

/// Opaque where the file names a picture that cannot be read.
Surface read_mask(Context& context, const Object& bsdf) {
  const bool given = bsdf.find("opacity") || bsdf.child_named("opacity");
  const ColorTexture opacity = read_number_texture(context, bsdf, "opacity", given ? 1.0f : 0.5f);
  Surface surface = read_surface(context, only_nested(bsdf));
  return node_of(surface.material,
                 product(context, bsdf, textured_opacity(opacity.color.x, opacity.texture),
                         surface.material.opacity));
}

Surface read_normal_map(Context& context, const Object& bsdf) {
  const Object* named = bsdf.child_named("normalmap");
  const Object* texture = named ? named : bsdf.child("texture");
  if (!texture) fail(bsdf.element(), "bsdf 'normalmap' has no texture inside");
  const ColorTexture map = read_texture(context, *texture, Quantity::plain, Color(1.0f));
  if (map.texture == no_texture) {
    report_replaced(context, bsdf, "a map that is no image is left out");
    return read_surface(context, only_nested(bsdf));
  }
  return read_map(context, bsdf, MaterialNode::normal_map, map, 1.0f);
}

Surface read_bump_map(Context& context, const Object& bsdf) {
  const Object* texture = bsdf.child("texture");
  if (!texture) fail(bsdf.element(), "bsdf '{}' has no texture inside", bsdf.type());
  const ColorTexture map = read_texture(context, *texture, Quantity::plain, Color(1.0f));
  return read_map(context, bsdf, MaterialNode::bump_map, map,
                  bsdf.number("scale", 1.0f) * luminance(map.color));
}

Surface read_blend(Context& context, const Object& bsdf) {
  const std::vector<const Object*> parts = bsdf.children("bsdf");
  if (parts.size() != 2) {
    fail(bsdf.element(), "bsdf 'blendbsdf' has {} bsdfs inside; expected 2", parts.size());
  }
  const ColorTexture weight = read_number_texture(context, bsdf, "weight", 0.5f);
  return blend(context, bsdf, weight, read_surface(context, *parts[0]),
               read_surface(context, *parts[1]));
}

/// What the weights leave over is absorbed.
Surface read_mixture(Context& context, const Object& bsdf) {
  const std::vector<const Object*> parts = bsdf.children("bsdf");
  const std::vector<float> weights = read_weights(bsdf, parts.size());
  Surface result = diffuse_of({Color(0.0f)});
  float sum = 0.0f;
  for (const float weight : weights) sum += weight;
  float share = std::max(0.0f, 1.0f - sum);  // of `result`
  for (std::size_t i = 0; i < parts.size(); ++i) {
    share += weights[i];
    const float weight = share > 0.0f ? weights[i] / share : 0.0f;
    result = blend(context, bsdf, {Color(weight)}, result, read_surface(context, *parts[i]));
  }
  return result;
}

/// coating: what is inside.
Surface read_wrapper(Context& context, const Object& bsdf) {
  report_replaced(context, bsdf, "the (first) bsdf inside is used as it is");
  bsdf.ignore_all();
  return read_surface(context, only_nested(bsdf));
}

Surface read_null(Context&, const Object&) {
  Surface surface = diffuse_of({Color(0.0f)});
  surface.material.opacity = constant_opacity(0.0f);
  surface.invisible = true;
  return surface;
}

}  // namespace pt::mitsuba
