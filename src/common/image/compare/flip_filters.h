// The filters of FLIP: what an eye resolves, and what it takes for an edge or a point.
#pragma once

#include <array>
#include <vector>

#include "common/image/compare/convolve.h"

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
