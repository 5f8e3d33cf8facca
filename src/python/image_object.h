// An image in memory, the host's or a GPU's, as Python sees it.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "app/render/render_session.h"

namespace pt::python {

/// Without a copy; lives as long as anybody refers to it.
using ArrayOut = nanobind::ndarray<nanobind::array_api>;

class ImageObject {
 public:
  explicit ImageObject(RenderResult result) : result_(std::move(result)) {}
  /// Of an image that was read.
  ImageObject(Image image, ImageMetadata header) {
    result_.has_image = true;
    result_.image = std::move(image);
    result_.header = std::move(header);
  }

  const RenderResult& result() const { return result_; }
  /// Size and layers; image() has the pixels.
  const Image& frame() const { return result_.image; }
  Image& frame() { return result_.image; }
  /// In the host's memory: of a GPU's image a copy, made when it is first asked for.
  Image& image();
  /// Null: the host's memory is the only one.
  const DeviceImage* device_image() const { return result_.device_image.get(); }

  std::string statistics();  ///< JSON; empty: of an image that was read
  std::string table();
  /// Writes an image with what is known of it. `exposure`: as the option; empty: the render's.
  void save(const std::string& path, const std::string& exposure);
  /// The files that the options name, of statistics.
  void write_statistics();

 private:
  RenderReport report();  ///< a copy

  std::mutex mutex_;  ///< of the host's copy of the pixels, and of the report
  RenderResult result_;
};

}  // namespace pt::python
