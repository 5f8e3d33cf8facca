// <film> and <sampler>: the defaults of the image.
#include <fmt/format.h>

#include "common/scene/load/mitsuba/sensor.h"
#include "common/scene/prepare/prepare_filter.h"

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

/// The crop window, in pixels of the film.
void read_crop(Context& context, const Object& film) {
  SceneDefaults& defaults = context.scene.defaults;
  const CropWindow whole{0, 0, *defaults.width, *defaults.height};
  CropWindow crop;
  crop.x0 = film.integer("crop_offset_x").value_or(0);
  crop.y0 = film.integer("crop_offset_y").value_or(0);
  const int width = film.integer("crop_width").value_or(whole.x1);
  const int height = film.integer("crop_height").value_or(whole.y1);
  if (crop.x0 < 0 || crop.y0 < 0 || width < 1 || height < 1 || width > whole.x1 - crop.x0 ||
      height > whole.y1 - crop.y0) {
    fail(film.element(), fmt::format("a crop of {}x{} pixels at {},{}; expected a part of the film "
                                     "of {}x{}",
                                     width, height, crop.x0, crop.y0, whole.x1, whole.y1));
  }
  crop.x1 = crop.x0 + width, crop.y1 = crop.y0 + height;
  if (!(crop == whole)) defaults.crop = crop;
}

/// Names as in Mitsuba; its `catmullrom` is a Mitchell filter.
void read_filter(Context& context, const Object& filter) {
  const std::string type = filter.type();
  FilterChoice choice;
  if (type == "box") {
    choice.a = filter.number("radius", choice.a);
  } else if (type == "tent") {
    choice = default_filter(FilterKind::tent);
    choice.a = filter.number("radius", choice.a);
  } else if (type == "gaussian") {
    choice = default_filter(FilterKind::gaussian);
    choice.a = filter.number("stddev", choice.a);
  } else if (type == "mitchell") {
    choice = default_filter(FilterKind::mitchell);
    choice.a = filter.number("b", choice.a);  // B and C in the file: names are in snake_case here
    choice.b = filter.number("c", choice.b);
  } else if (type == "catmullrom") {
    choice = {FilterKind::mitchell, 0.0f, 0.5f};
  } else if (type == "lanczos") {
    choice = default_filter(FilterKind::lanczos);
    choice.a = static_cast<float>(filter.integer("lobes").value_or(3));
  } else {
    context.warn_once(
        "rfilter", filter.element(),
        fmt::format("reconstruction filter '{}' is not supported: box is used", type));
  }
  if (choice.kind != FilterKind::mitchell && !(choice.a > 0.0f)) {
    context.warn_once("filter size", filter.element(),
                      fmt::format("filter '{}' of size {}; expected one above 0: its default is "
                                  "used",
                                  type, choice.a));
    choice = default_filter(choice.kind);
  }
  context.scene.defaults.filter = choice;
}

}  // namespace

void read_film(Context& context, const Object& film) {
  context.scene.defaults.width = image_side(film, "width", 768);
  context.scene.defaults.height = image_side(film, "height", 576);
  read_crop(context, film);
  // About the file that Mitsuba would write.
  film.ignore({"file_format", "pixel_format", "component_format", "gamma", "banner", "exposure",
               "tonemap_method", "high_quality_edges", "attach_log", "compensate", "sample_border",
               "variable", "digits", "key", "burn"});
  if (const Object* filter = film.child("rfilter")) read_filter(context, *filter);
}

void read_sampler(Context& context, const Object& sampler) {
  const std::optional<int> count = sampler.integer("sample_count");
  sampler.ignore({"seed", "scramble", "jitter", "dimension"});
  if (!count) return;
  if (*count < 1) {
    return context.warn_once(
        "sample_count", sampler.element(),
        fmt::format("sample_count {}; expected 1 or more: it is ignored", *count));
  }
  context.scene.defaults.spp = count;
}

}  // namespace pt::mitsuba
