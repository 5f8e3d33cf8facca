// The filters of FLIP: what an eye resolves, and what it takes for an edge or a point.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace pt {

struct ImagePlane {
  int width = 0, height = 0;
  std::vector<float> values;  ///< [y][x]

  ImagePlane() = default;
  ImagePlane(int w, int h)
      : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
};

/// Separable convolution of one channel, whose border is repeated beyond the image. Each value
/// becomes the sum over (i, j) of x[i] y[j] times the value (i, j) to the right and down of it, i
/// and j counted from the middles of the kernels, which have odd sizes.
ImagePlane convolve(const ImagePlane& image, std::span<const float> x, std::span<const float> y);

}  // namespace pt

namespace pt::flip {

using Kernel = std::vector<float>;

/// How far from a pixel the filters below look, in pixels along x and y.
int reach(double pixels_per_degree);

/// Contrast sensitivity as sums of Gaussians a sqrt(pi / b) exp(-pi^2 d^2 / b), d in degrees, for
/// the three opponent channels.
std::array<ImagePlane, 3> blur(const std::array<ImagePlane, 3>& opponent, double pixels_per_degree);

/// Lengths of the gradient (edges) and of the second derivative (points) of achromatic values.
struct Features {
  ImagePlane edges, points;
};
Features find_features(const ImagePlane& achromatic, double pixels_per_degree);

}  // namespace pt::flip
