#include "common/image/compare/flip_filters.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace pt {
namespace {

/// Adds `count` weighted values. Each sum adds its terms in the kernel's order, whoever calls this
/// for how many at a time: so vectors of processors change no bit.
void add_weighted(const float* from, float weight, float* to, int count) {
  for (int i = 0; i < count; ++i) to[i] += weight * from[i];
}

/// A row with its first and last value repeated on both sides.
std::vector<float> padded(const float* row, int width, int radius) {
  std::vector<float> result(static_cast<std::size_t>(width + 2 * radius));
  for (int i = 0; i < width + 2 * radius; ++i) {
    result[static_cast<std::size_t>(i)] = row[std::clamp(i - radius, 0, width - 1)];
  }
  return result;
}

}  // namespace

ImagePlane convolve(const ImagePlane& image, std::span<const float> x, std::span<const float> y) {
  ImagePlane rows(image.width, image.height), result = rows;
  const auto row_of = [&](auto& plane, int row) {
    return plane.values.data() + std::ptrdiff_t{row} * image.width;
  };
  for (int row = 0; row < image.height; ++row) {
    const int radius = static_cast<int>(x.size() / 2);
    const std::vector<float> from = padded(row_of(image, row), image.width, radius);
    for (std::size_t k = 0; k < x.size(); ++k) {
      add_weighted(&from[k], x[k], row_of(rows, row), image.width);
    }
  }
  for (int row = 0; row < image.height; ++row) {
    const int radius = static_cast<int>(y.size() / 2);
    for (int k = -radius; k <= radius; ++k) {
      const int from = std::clamp(row + k, 0, image.height - 1);
      add_weighted(row_of(rows, from), y[static_cast<std::size_t>(k + radius)], row_of(result, row),
                   image.width);
    }
  }
  return result;
}

}  // namespace pt

namespace pt::flip {

namespace {

constexpr double pi = std::numbers::pi;

struct Gaussian {
  double a, b;
};
constexpr double largest_b = 0.04;
constexpr std::array<std::array<Gaussian, 2>, 3> sensitivity = {
    {{{{1, 0.0047}, {0, 1e-5}}}, {{{1, 0.0053}, {0, 1e-5}}}, {{{34.1, 0.04}, {13.5, 0.025}}}}};
constexpr double feature_width = 0.082;  // degrees

template <class Function>
Kernel make_kernel(int radius, Function&& function) {
  Kernel kernel;
  for (int i = -radius; i <= radius; ++i) kernel.push_back(static_cast<float>(function(i)));
  return kernel;
}

double sum_of(const Kernel& kernel) {
  double sum = 0;
  for (const float value : kernel) sum += value;
  return sum;
}

int blur_radius(double pixels_per_degree) {
  return static_cast<int>(std::ceil(3 * std::sqrt(largest_b / (2 * pi * pi)) * pixels_per_degree));
}

double feature_deviation(double pixels_per_degree) {
  return 0.5 * feature_width * pixels_per_degree;
}

int feature_radius(double pixels_per_degree) {
  return static_cast<int>(std::ceil(3 * feature_deviation(pixels_per_degree)));
}

ImagePlane blur_channel(const ImagePlane& plane, const std::array<Gaussian, 2>& gaussians,
                        double pixels_per_degree) {
  const int radius = blur_radius(pixels_per_degree);
  ImagePlane result(plane.width, plane.height);
  double total = 0;
  for (const Gaussian& g : gaussians) {
    if (g.a == 0) continue;
    const Kernel kernel = make_kernel(radius, [&](int i) {
      const double degrees = i / pixels_per_degree;
      return std::exp(-pi * pi * degrees * degrees / g.b);
    });
    const double weight = g.a * std::sqrt(pi / g.b);
    total += weight * sum_of(kernel) * sum_of(kernel);
    const ImagePlane part = convolve(plane, kernel, kernel);
    for (std::size_t i = 0; i < part.values.size(); ++i) {
      result.values[i] += static_cast<float>(weight) * part.values[i];
    }
  }
  for (float& value : result.values) value *= static_cast<float>(1 / total);
  return result;
}

/// Scales the kernel: its positive values add up to 1, its negative ones to -1.
Kernel balanced(Kernel kernel) {
  double positive = 0, negative = 0;
  for (const float value : kernel) (value > 0 ? positive : negative) += std::abs(value);
  for (float& value : kernel) value = static_cast<float>(value / (value > 0 ? positive : negative));
  return kernel;
}

/// The length of the two derivatives that `derivative` takes along x and y.
ImagePlane length_of(const ImagePlane& plane, const Kernel& derivative, const Kernel& across) {
  ImagePlane x = convolve(plane, derivative, across);
  const ImagePlane y = convolve(plane, across, derivative);
  for (std::size_t i = 0; i < x.values.size(); ++i)
    x.values[i] = std::hypot(x.values[i], y.values[i]);
  return x;
}

}  // namespace

int reach(double pixels_per_degree) {
  return std::max(blur_radius(pixels_per_degree), feature_radius(pixels_per_degree));
}

std::array<ImagePlane, 3> blur(const std::array<ImagePlane, 3>& opponent,
                               double pixels_per_degree) {
  std::array<ImagePlane, 3> result;
  for (std::size_t c = 0; c < 3; ++c) {
    result[c] = blur_channel(opponent[c], sensitivity[c], pixels_per_degree);
  }
  return result;
}

Features find_features(const ImagePlane& achromatic, double pixels_per_degree) {
  const double deviation = feature_deviation(pixels_per_degree);
  const int radius = feature_radius(pixels_per_degree);
  const auto gauss = [&](int i) { return std::exp(-i * i / (2 * deviation * deviation)); };
  Kernel across = make_kernel(radius, gauss);
  for (float& value : across) value /= static_cast<float>(sum_of(make_kernel(radius, gauss)));
  const Kernel first = balanced(make_kernel(radius, [&](int i) { return -i * gauss(i); }));
  const Kernel second = balanced(
      make_kernel(radius, [&](int i) { return (i * i / (deviation * deviation) - 1) * gauss(i); }));
  return {length_of(achromatic, first, across), length_of(achromatic, second, across)};
}

}  // namespace pt::flip
