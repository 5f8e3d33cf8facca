// An image in memory as Python sees it.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <memory>
#include <string>
#include <vector>

#include "app/render_session.h"

namespace pt::python {

/// On the CPU, without a copy; lives as long as anybody refers to it.
using ArrayOut = nanobind::ndarray<nanobind::array_api, nanobind::device::cpu>;

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
  const Image& image() const { return result_.image; }
  Image& image() { return result_.image; }

  std::string statistics() const;  ///< JSON; empty: of an image that was read
  std::string table() const;
  /// Writes an image with what is known of it. `exposure`: as the option; empty: the render's.
  void save(const std::string& path, const std::string& exposure);
  /// The files that the options name, of statistics.
  void write_statistics() const;

 private:
  RenderResult result_;
};

}  // namespace pt::python
