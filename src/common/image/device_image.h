// An image whose pixels are in the memory of the GPU that has rendered them.
#pragma once

#include <utility>
#include <vector>

#include "common/image/image.h"

namespace pt {

/// Owns its memory, which no later render touches.
class DeviceImage {
 public:
  virtual ~DeviceImage() = default;

  /// Size, place and layers; no rgb.
  const Image& frame() const { return frame_; }
  /// Image::rgb in the device's memory, complete.
  virtual float* rgb() const = 0;
  /// As CUDA numbers it.
  virtual int device() const = 0;
  /// The same in the host's memory. Throws Error.
  virtual std::vector<float> download() const = 0;

 protected:
  explicit DeviceImage(Image frame) : frame_(std::move(frame)) {}

 private:
  Image frame_;
};

}  // namespace pt
