// An image in memory, the host's or a GPU's, as Python sees it.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "app/render/render_outputs.h"
#include "app/render/render_session.h"

namespace pt::python {

/// An array without a copy, which keeps the image alive.
using ArrayOut = nanobind::ndarray<nanobind::array_api>;

class ImageObject {
 public:
  explicit ImageObject(RenderResult result) : result_(std::move(result)) {}
  /// An image that was read from a file, or that Python made.
  explicit ImageObject(Image image, ImageMetadata header = {}) {
    result_.has_image = true;
    result_.image = std::move(image);
    result_.header = std::move(header);
  }

  const RenderResult& result() const { return result_; }
  /// Size and layers; image() has the pixels.
  const Image& frame() const { return result_.image; }
  Image& frame() { return result_.image; }
  /// In the host's memory; a GPU's image is copied at the first call.
  Image& image();
  /// Null: the image is in the host's memory alone.
  const DeviceImage* device_image() const { return result_.device_image.get(); }

  std::string statistics();  ///< JSON; empty for an image that was read
  std::string table();
  /// How a PNG shows it: three bytes a pixel. `exposure`: as for save().
  std::string srgb(const std::string& exposure);
  std::string png(const std::string& exposure);
  /// What a file without an exposure of its own is given, as ImageState holds it.
  std::string default_exposure() const;
  void set_default_exposure(const std::string& text);
  /// Writes the image with its header. `exposure`: as the option; empty: the render's.
  void save(const std::string& path, const std::string& exposure);
  /// Writes the files of statistics that the options name.
  void write_statistics();

 private:
  RenderReport report();  ///< a copy
  std::optional<Exposure> exposure_of(const std::string& path, const std::string& exposure);

  std::mutex mutex_;  ///< of the host's pixels and the report
  RenderResult result_;
};

}  // namespace pt::python
