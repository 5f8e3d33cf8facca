// <film> and <sampler>: the defaults of the image.
#include <fmt/format.h>

#include "common/scene/mitsuba/sensor.h"

namespace pt::mitsuba {
namespace {

constexpr int max_image_side = 65535;

int image_side(const Object& film, std::string_view name, int fallback) {
  const int side = film.integer(name).value_or(fallback);
  if (side < 1 || side > max_image_side) {
    fail(film.element(),
         fmt::format("{} of the film is {}; expected 1 to {} pixels", name, side, max_image_side));
  }
  return side;
}

}  // namespace

void read_film(Context& context, const Object& film) {
  context.scene.defaults.width = image_side(film, "width", 768);
  context.scene.defaults.height = image_side(film, "height", 576);
  if (film.find("crop_width") || film.find("crop_height") || film.find("crop_offset_x") ||
      film.find("crop_offset_y")) {
    context.warn_once("crop", film.element(),
                      "a crop of the film is not supported: the whole image is rendered");
    film.ignore({"crop_width", "crop_height", "crop_offset_x", "crop_offset_y"});
  }
  // About the file that Mitsuba would write.
  film.ignore({"file_format", "pixel_format", "component_format", "gamma", "banner", "exposure",
               "tonemap_method", "high_quality_edges", "attach_log", "compensate", "sample_border",
               "variable", "digits", "key", "burn"});
  const Object* filter = film.child("rfilter");
  if (filter && filter->type() != "box") {
    context.warn_once(
        "rfilter", filter->element(),
        fmt::format("reconstruction filter '{}' is not supported: box is used", filter->type()));
  }
}

void read_sampler(Context& context, const Object& sampler) {
  const std::optional<int> count = sampler.integer("sample_count");
  sampler.ignore({"seed", "scramble", "jitter", "dimension"});
  if (!count) return;
  if (*count < 1) {
    fail(sampler.element(), fmt::format("sample_count {}; expected 1 or more", *count));
  }
  context.scene.defaults.spp = count;
}

}  // namespace pt::mitsuba
