// bsdfs around other ones.
#include <fmt/format.h>

#include "common/scene/mitsuba/surface_kinds.h"

namespace pt::mitsuba {
namespace {

const Object& only_nested(const Object& bsdf) {
  const Object* nested = bsdf.child("bsdf");
  if (!nested) fail(bsdf.element(), fmt::format("bsdf '{}' has no bsdf inside", bsdf.type()));
  return *nested;
}

}  // namespace

Surface read_two_sided(Context& context, const Object& bsdf) {
  if (bsdf.children("bsdf").size() > 1) {
    context.warn_once("two sides", bsdf.element(),
                      "a different bsdf on each side is not supported: the first is used on both");
  }
  Surface surface = read_surface(context, only_nested(bsdf));
  surface.material.one_sided = false;
  return surface;
}

Surface read_mask(Context& context, const Object& bsdf) {
  const ColorTexture opacity = read_color_texture(context, bsdf, "opacity", Color(0.5f));
  Surface surface = read_surface(context, only_nested(bsdf));
  if (opacity.texture == no_texture && is_black(opacity.color)) {
    surface.invisible = true;
  } else if (opacity.texture != no_texture || opacity.color != Color(1.0f)) {
    report_replaced(context, bsdf, "the bsdf inside is used, opaque");
  }
  return surface;
}

/// bumpmap, normalmap, blendbsdf, coating: what is inside, or the first of it.
Surface read_wrapper(Context& context, const Object& bsdf) {
  report_replaced(context, bsdf, "the (first) bsdf inside is used as it is");
  bsdf.ignore_all();
  return read_surface(context, only_nested(bsdf));
}

Surface read_null(Context&, const Object&) {
  Surface surface = diffuse_of({Color(0.0f)});
  surface.invisible = true;
  return surface;
}

}  // namespace pt::mitsuba
