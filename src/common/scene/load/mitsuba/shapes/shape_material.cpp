// The material of a shape: its bsdf and its emitter.
#include <fmt/format.h>

#include "common/scene/load/mitsuba/media/media.h"
#include "common/scene/load/mitsuba/shapes/shapes.h"
#include "common/scene/load/mitsuba/surfaces/surfaces.h"

namespace pt::mitsuba {
namespace {

/// Mitsuba's surface of a shape without a bsdf.
Surface default_surface(const Object* emitter) {
  Surface surface;
  surface.material = make_diffuse(Color(emitter ? 0.0f : 0.5f));
  surface.material.one_sided = true;
  return surface;
}

void add_emission(Context& context, const Object& emitter, Surface& surface) {
  if (emitter.type() != "area") {
    context.warn_once(
        "shape emitter " + emitter.type(), emitter.element(),
        fmt::format("emitter '{}' on a shape is not supported: it is left out", emitter.type()));
    return context.add_left_out(emitter);
  }
  context.add_lit();
  emitter.ignore({"sampling_weight"});
  const ColorTexture radiance = read_color_texture(
      context, emitter, emission_name(emitter, "radiance"), Color(1.0f), Quantity::emission);
  surface.material.emission = {radiance.color, radiance.texture};
  if (surface.invisible) {
    context.warn_once("invisible emitter", emitter.element(),
                      "an emitter that light passes is not supported: it is black instead");
    surface = default_surface(&emitter);
    surface.material.emission = {radiance.color, radiance.texture};
  }
}

/// By their ids; what has none is its shape's.
void name_material(SceneData& scene, std::uint32_t material, const Object& shape,
                   const Object* bsdf, const Object* emitter) {
  const std::string own = shape.id();
  const auto name_of = [&](const Object* object, const char* part) {
    const std::string id = object ? object->id() : "";
    return !id.empty() || own.empty() ? id : own + part;
  };
  if (const std::string name = name_of(bsdf, ".bsdf"); !name.empty())
    scene.names.materials[material] = name;
  if (!emitter) return;
  if (const std::string name = name_of(emitter, ""); !name.empty())
    scene.names.emitters[material] = name;
}

const Object* emitter_of(Context& context, const Object& shape, std::uint32_t group) {
  const Object* emitter = shape.child("emitter");
  if (!emitter) emitter = shape.child("luminaire");
  if (emitter) context.on_shapes.insert(emitter);
  if (!emitter || group == 0) return emitter;
  context.warn_once("instanced emitter", emitter->element(),
                    "an emitter in a shapegroup is not supported: it is black instead");
  context.add_left_out(*emitter);
  return nullptr;
}

}  // namespace

std::optional<std::uint32_t> material_of(Context& context, const Object& shape,
                                         std::uint32_t group) {
  const Object* bsdf = shape.child("bsdf");
  const Object* emitter = emitter_of(context, shape, group);
  const ShapeMedia media = media_of(context, shape);
  const bool has_medium = !shape.children("medium").empty();
  if (has_medium && !media.any && !bsdf && !emitter) return std::nullopt;
  constexpr std::uint32_t invisible = 0xffffffffu;
  const auto [entry, is_new] = context.materials.try_emplace(
      {bsdf, emitter, media.boundary.outside, media.boundary.inside}, invisible);
  if (is_new) {
    Surface surface = bsdf ? read_surface(context, *bsdf) : default_surface(emitter);
    const bool has_nothing = bsdf ? surface.invisible : has_medium && !emitter;
    if (media.any) {
      const bool passes = has_nothing && !emitter;
      if (passes) surface = Surface();
      surface.material.is_boundary = true;
      surface.material.media = media.boundary;
      surface.material.passes = passes;
    }
    if (emitter) add_emission(context, *emitter, surface);
    if (!surface.invisible) {
      entry->second = context.scene.add_material(surface.material);
      name_material(context.scene, entry->second, shape, bsdf, emitter);
    }
  }
  return entry->second == invisible ? std::nullopt : std::optional(entry->second);
}

}  // namespace pt::mitsuba
