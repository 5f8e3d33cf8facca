#include "python/image_object.h"

#include <fmt/format.h>

#include "app/options/option_values.h"
#include "app/render_outputs.h"
#include "common/error/error.h"

namespace pt::python {

Image& ImageObject::image() {
  const std::lock_guard lock(mutex_);
  if (result_.device_image && result_.image.rgb.empty())
    result_.image.rgb = result_.device_image->download();
  return result_.image;
}

std::string ImageObject::statistics() const {
  return result_.report.runs.empty() ? "" : report_json(result_.options, result_.report);
}

std::string ImageObject::table() const {
  return result_.report.runs.empty() ? "" : report_table(result_.options, result_.report);
}

void ImageObject::save(const std::string& path, const std::string& exposure) {
  check_image_path(path);
  const ExposureChoice choice =
      exposure.empty() ? result_.options.exposure : parse_exposure("exposure", exposure);
  const auto chosen = exposure_for(path, choice, image(), result_.measures_exposure);
  if (chosen) result_.report.exposure = chosen->stops;
  write_image(path, image(), result_.header, {chosen ? chosen->stops : 0.0f});
}

void ImageObject::write_statistics() const {
  pt::write_statistics(result_.options, result_.report);
}

}  // namespace pt::python
