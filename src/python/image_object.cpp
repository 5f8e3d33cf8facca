#include "python/image_object.h"

#include <fmt/format.h>

#include "app/options/option_values.h"
#include "app/render/render_outputs.h"
#include "common/error/error.h"

namespace pt::python {

Image& ImageObject::image() {
  const std::lock_guard lock(mutex_);
  if (result_.device_image && result_.image.rgb.empty())
    result_.image.rgb = result_.device_image->download();
  return result_.image;
}

RenderReport ImageObject::report() {
  const std::lock_guard lock(mutex_);
  return result_.report;
}

std::string ImageObject::statistics() {
  const RenderReport now = report();
  return now.runs.empty() ? "" : report_json(result_.options, now);
}

std::string ImageObject::table() {
  const RenderReport now = report();
  return now.runs.empty() ? "" : report_table(result_.options, now);
}

void ImageObject::save(const std::string& path, const std::string& exposure) {
  check_image_path(path);
  const ExposureChoice choice =
      exposure.empty() ? result_.options.exposure : parse_exposure("exposure", exposure);
  const auto chosen = exposure_for(path, choice, image(), result_.measures_exposure);
  if (chosen) {
    const std::lock_guard lock(mutex_);
    result_.report.exposure = chosen->stops;
  }
  write_image(path, image(), result_.header, {chosen ? chosen->stops : 0.0f});
}

void ImageObject::write_statistics() {
  Attempts attempts;
  pt::write_statistics(result_.options, report(), attempts);
  attempts.check();
}

}  // namespace pt::python
