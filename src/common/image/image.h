// An image, in the host's memory or in a GPU's: linear RGB, row by row from the top.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace pt {

/// Further values of an image's pixels: a layer of an EXR. One of the two arrays is empty.
struct ImageLayer {
  std::string name;
  std::string channels;                ///< a letter each
  std::vector<float> values;           ///< [y][x][channel]
  std::vector<std::uint32_t> numbers;  ///< the same, whole numbers
};

/// Where an image lies that is a part of a larger one.
struct ImagePlace {
  int x = 0, y = 0;           ///< its upper left pixel
  int width = 0, height = 0;  ///< of the larger one; 0: the image is no part

  bool operator==(const ImagePlace&) const = default;
};

struct Image {
  int width = 0;
  int height = 0;
  std::vector<float> rgb;            ///< 3 * width * height linear radiance values
  std::vector<ImageLayer> layers{};  ///< for EXR alone
  ImagePlace place{};                ///< an EXR's data window in its display window
  bool is_compressed = true;         ///< in an EXR: else it is written faster

  float* pixel(int x, int y) { return rgb.data() + 3 * (static_cast<std::size_t>(y) * width + x); }
  const float* pixel(int x, int y) const {
    return rgb.data() + 3 * (static_cast<std::size_t>(y) * width + x);
  }
};

/// An image whose pixels are in the memory of the GPU that has rendered them. Owns its memory,
/// which no later render touches.
class DeviceImage {
 public:
  virtual ~DeviceImage() = default;

  /// Size, place and layers; no rgb.
  const Image& frame() const { return frame_; }
  /// Image::rgb in the device's memory, complete.
  virtual float* rgb() const = 0;
  /// As CUDA numbers it.
  virtual int device() const = 0;
  /// Copies rgb() to the host's memory. Throws Error.
  virtual std::vector<float> download() const = 0;

 protected:
  explicit DeviceImage(Image frame) : frame_(std::move(frame)) {}

 private:
  Image frame_;
};

}  // namespace pt
