
#include "common/scene/load/files/images/image_files.h"
#include "common/scene/load/files/importer.h"
#include "common/scene/load/pbrt/scene_parts.h"

namespace pt::pbrt {
namespace {

float mean_luminance(const Image& image) {
  double sum = 0;
  for (std::size_t i = 0; i + 2 < image.rgb.size(); i += 3) {
    sum += 0.2126 * image.rgb[i] + 0.7152 * image.rgb[i + 1] + 0.0722 * image.rgb[i + 2];
  }
  return static_cast<float>(sum / (static_cast<double>(image.width) * image.height));
}

}  // namespace

const Surface& ShapeMaterials::surface_of(const ShapeEntity& shape) {
  const MaterialReference& reference = shape.material;
  const auto found = surfaces_.find(reference);
  if (found != surfaces_.end()) return found->second;
  context_.mappings.clear();
  Surface surface;
  surface.material = make_diffuse(Color(0.5f));
  context_.reporter.attempt("diffuse grey", "is used", [&] {
    surface = read_surface(context_, reference, shape.shape.parameters.place());
  });
  return surfaces_.emplace(reference, std::move(surface)).first->second;
}

const ShapeMaterials::AreaLight& ShapeMaterials::light_of(const Entity& entity) {
  const auto [entry, is_new] = lights_.try_emplace(&entity);
  AreaLight& light = entry->second;
  if (!is_new) return light;
  context_.reporter.attempt(entity.parameters.what(), "is dark",
                            [&] { light = read_light(entity); });
  return light;
}

/// Its picture is looked up like a texture, but not repeated.
ShapeMaterials::AreaLight ShapeMaterials::read_light(const Entity& entity) {
  AreaLight light;
  const Parameters& parameters = entity.parameters;
  if (entity.type != "diffuse" && entity.type != "area") {
    context_.reporter.warn_once("area light " + entity.type, parameters.place(),
                                "area light '{}' is not known: diffuse is used", entity.type);
  }
  const Color white = to_srgb(Color(1.0f), entity.space);
  const Parameter* filename = parameters.find("filename", {"string"});
  light.emission.radiance = read_light_scale(context_, parameters);
  if (filename && parameters.find("L")) {
    context_.reporter.warn_once("L of a picture", filename->place,
                                "an area light of both 'L' and 'filename': 'L' is ignored");
  } else {
    light.emission.radiance *= read_color(context_, parameters, "L", white, Quantity::illuminant);
  }
  light.two_sided = parameters.boolean("twosided", false);
  light.power = parameters.number("power", 0.0f);
  parameters.ignore({"nsamples", "samples"});  // of pbrt-v3
  if (filename) {
    attempt_file(context_, *filename, "a constant light", [&] {
      const auto path = context_.resolve(filename->place, parameters.text("filename", ""));
      Texture look;
      look.wrap_u = look.wrap_v = TextureWrap::clamp;
      light.emission.texture = context_.textures.add_file(path, look);
      if (light.power > 0.0f) light.mean = mean_luminance(read_radiance_image(path));
    });
  }
  parameters.report_unused(context_.reporter);
  return light;
}

void ShapeMaterials::add_light(const ShapeEntity& shape, ShapeMaterial& result) {
  const FileLocation& place = shape.shape.parameters.place();
  if (shape.group != 0) {
    context_.reporter.warn_once("instanced light", place,
                                "an area light in an object is not supported: it is dark");
    return;
  }
  if (result.invisible) {
    context_.reporter.warn_once("invisible light", place,
                                "a light that rays pass (of the material 'interface' or an alpha "
                                "of 0) is not supported: it is a black surface that emits");
    result.material = make_diffuse(Color(0.0f));
    result.invisible = false;
  }
  const AreaLight& light = light_of(*shape.area_light);
  result.material.emission = light.emission;
  result.emits = !is_black(light.emission.radiance);
  result.two_sided = light.two_sided;
  result.power = light.power;
  result.light_mean = light.mean;
  context_.lit = true;
}

/// A shape of the material 'interface' is visible where it parts two media.
void ShapeMaterials::set_media(const ShapeEntity& shape, ShapeMaterial& result) {
  const MediumBoundary media = media_of(context_, shape);
  if (media.inside == media.outside) return;
  result.material.is_boundary = true;
  result.material.passes = result.invisible;
  result.material.media = media;
  result.invisible = false;
  if (result.material.passes && shape.area_light) {
    context_.reporter.warn_once(
        "light of a boundary", shape.shape.parameters.place(),
        "an area light of the material 'interface' between two media is ignored");
  }
}

ShapeMaterial ShapeMaterials::read(const ShapeEntity& shape) {
  const Surface& surface = surface_of(shape);
  ShapeMaterial result;
  result.material = surface.material;
  result.invisible = surface.invisible;
  context_.mappings = surface.mappings;
  set_media(shape, result);
  const ColorTexture alpha = read_number_texture(context_, shape.shape.parameters, "alpha", 1.0f);
  // In pbrt-v3 what is not quite clear is opaque.
  const float cutoff = context_.description.is_earlier ? 1e-4f : 0.0f;
  const bool has_alpha = !alpha.is_constant() || alpha.color.x < 1.0f;
  if (!result.invisible && (has_alpha || !surface.keeps_opacity)) {
    result.material.opacity = alpha.is_constant()
                                  ? constant_opacity(glm::clamp(alpha.color.x, 0.0f, 1.0f))
                                  : textured_opacity(alpha.color.x, alpha.texture, cutoff);
    result.invisible = alpha.is_constant() && alpha.color.x <= 0.0f;
  }
  if (shape.area_light && !result.material.passes) add_light(shape, result);
  if (result.material.emission.texture != no_texture) context_.add_mapping({});
  result.mapping =
      common_mapping(context_.mappings, shape.shape.parameters.place(), context_.reporter);
  result.textured = is_textured(context_.scene, result.material);
  result.tangents = needs_tangents(context_.scene, result.material);
  return result;
}

}  // namespace pt::pbrt
