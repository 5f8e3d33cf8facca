#include "common/image/compare/flip.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <numeric>
#include <vector>

#include "common/image/compare/flip_filters.h"

namespace pt {
namespace {

// FLIP by tiles, in parallel: a pixel's error depends only on pixels within the filters' reach.

/// The errors [y][x] of parts of two images, which have one size.
using FlipOfParts = std::function<std::vector<float>(const Image& test, const Image& reference)>;

/// Pixels [x0, x1) x [y0, y1).
struct Part {
  int x0, y0, x1, y1;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
};

Part widened(const Part& part, int by, const Image& image) {
  return {std::max(part.x0 - by, 0), std::max(part.y0 - by, 0), std::min(part.x1 + by, image.width),
          std::min(part.y1 + by, image.height)};
}

std::size_t pixel_index(const Image& image, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
         static_cast<std::size_t>(x);
}

bool are_same(const Image& a, const Image& b, const Part& part) {
  const auto bytes = 3 * sizeof(float) * static_cast<std::size_t>(part.width());
  for (int y = part.y0; y < part.y1; ++y) {
    const std::size_t first = 3 * pixel_index(a, part.x0, y);
    if (std::memcmp(&a.rgb[first], &b.rgb[first], bytes) != 0) return false;
  }
  return true;
}

Image cut(const Image& image, const Part& part) {
  Image result{part.width(), part.height(), {}};
  for (int y = part.y0; y < part.y1; ++y) {
    const auto first =
        image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * pixel_index(image, part.x0, y));
    result.rgb.insert(result.rgb.end(), first, first + 3 * part.width());
  }
  return result;
}

/// The same values as `flip_of_parts` of the whole images. Where pixels have the same bits as far
/// as the filters reach, errors are 0 and not computed.
std::vector<float> flip_by_tiles(const Image& test, const Image& reference, const FlipView& view,
                                 const FlipOfParts& flip_of_parts) {
  const int reach = flip::reach(view.pixels_per_degree);
  const int columns = (reference.width + view.tile - 1) / view.tile;
  const int rows = (reference.height + view.tile - 1) / view.tile;
  std::vector<float> errors(reference.rgb.size() / 3, 0.0f);
  tbb::parallel_for(0, columns * rows, [&](int i) {
    const int x = i % columns * view.tile, y = i / columns * view.tile;
    const Part tile = widened({x, y, x + view.tile, y + view.tile}, 0, reference);
    const Part part = widened(tile, reach, reference);
    if (are_same(test, reference, part)) return;
    const std::vector<float> found = flip_of_parts(cut(test, part), cut(reference, part));
    for (int row = tile.y0; row < tile.y1; ++row) {
      const std::ptrdiff_t from =
          std::ptrdiff_t{row - part.y0} * part.width() + (tile.x0 - part.x0);
      std::copy_n(
          found.begin() + from, tile.width(),
          errors.begin() + static_cast<std::ptrdiff_t>(pixel_index(reference, tile.x0, row)));
    }
  });
  return errors;
}

// The errors of an image.

using Triple = std::array<double, 3>;
using flip::Features;

// The papers' constants: colours are compared with the power qc, and what is beyond the share pc
// of the largest difference takes the last 1 - pt of the range; features have the power qf.
constexpr double qc = 0.7, pc = 0.4, pt_ = 0.95, qf = 0.5;

// Linear sRGB to XYZ, made of the primaries and D65 as fractions.
constexpr double to_xyz[3][3] = {
    {10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
    {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
    {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}};

/// XYZ to linear sRGB: the adjugate by the determinant.
struct FromXyz {
  double m[3][3] = {};
  FromXyz() {
    const auto& a = to_xyz;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      for (int c = 0; c < 3; ++c) {
        const int d = (c + 1) % 3, e = (c + 2) % 3;
        m[c][i] = a[j][d] * a[k][e] - a[j][e] * a[k][d];
      }
    }
    const double determinant = a[0][0] * m[0][0] + a[0][1] * m[1][0] + a[0][2] * m[2][0];
    for (auto& row : m) {
      for (double& value : row) value /= determinant;
    }
  }
};

Triple multiply(const double (&m)[3][3], const Triple& v) {
  Triple result{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) result[i] += m[i][j] * v[j];
  }
  return result;
}

const Triple& white() {
  static const Triple xyz = multiply(to_xyz, {1, 1, 1});
  return xyz;
}

/// XYZ relative to white.
Triple relative_xyz(const Triple& rgb) {
  Triple xyz = multiply(to_xyz, rgb);
  for (std::size_t c = 0; c < 3; ++c) xyz[c] /= white()[c];
  return xyz;
}

/// The opponent space YCxCz.
Triple to_opponent(const Triple& rgb) {
  const Triple t = relative_xyz(rgb);
  return {116 * t[1] - 16, 500 * (t[0] - t[1]), 200 * (t[1] - t[2])};
}

Triple from_opponent(const Triple& c) {
  static const FromXyz inverse;
  const double y = (c[0] + 16) / 116;
  return multiply(inverse.m,
                  {white()[0] * (y + c[1] / 500), white()[1] * y, white()[2] * (y - c[2] / 200)});
}

/// CIELAB with Hunt's effect: colours are weaker where it is dark.
Triple to_hunt_lab(const Triple& rgb) {
  constexpr double delta = 6.0 / 29;
  Triple t = relative_xyz(rgb);
  for (double& x : t) {
    x = x > delta * delta * delta ? std::cbrt(x) : x / (3 * delta * delta) + 4.0 / 29;
  }
  const double lightness = 116 * t[1] - 16;
  return {lightness, 0.01 * lightness * 500 * (t[0] - t[1]),
          0.01 * lightness * 200 * (t[1] - t[2])};
}

double hyab(const Triple& a, const Triple& b) {
  return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

/// The difference of two colours in [0, 1].
double color_error(const Triple& a, const Triple& b) {
  static const double largest = std::pow(hyab(to_hunt_lab({0, 1, 0}), to_hunt_lab({0, 0, 1})), qc);
  const double error = std::pow(hyab(to_hunt_lab(a), to_hunt_lab(b)), qc), knee = pc * largest;
  if (error < knee) return pt_ / knee * error;
  return pt_ + (error - knee) / (largest - knee) * (1 - pt_);
}

/// What the eye sees of one image.
struct Seen {
  std::array<ImagePlane, 3> opponent;  ///< blurred
  Features features;
};

template <class PixelOf>
Seen look(const Image& image, double pixels_per_degree, PixelOf&& pixel_of) {
  std::array<ImagePlane, 3> opponent;
  opponent.fill(ImagePlane(image.width, image.height));
  ImagePlane achromatic(image.width, image.height);
  for (std::size_t i = 0; i < achromatic.values.size(); ++i) {
    const Triple c = to_opponent(pixel_of(&image.rgb[3 * i]));
    for (std::size_t k = 0; k < 3; ++k) opponent[k].values[i] = static_cast<float>(c[k]);
    achromatic.values[i] = static_cast<float>((c[0] + 16) / 116);
  }
  return {flip::blur(opponent, pixels_per_degree),
          flip::find_features(achromatic, pixels_per_degree)};
}

Triple seen_color(const Seen& seen, std::size_t i) {
  Triple rgb = from_opponent(
      {seen.opponent[0].values[i], seen.opponent[1].values[i], seen.opponent[2].values[i]});
  for (double& value : rgb) value = std::clamp(value, 0.0, 1.0);
  return rgb;
}

/// Adds the errors of a part of two images, seen as `pixel_of` shows them, to the largest so far.
/// pixel_of(rgb) gives the displayed colour, linear, in [0, 1].
template <class PixelOf>
void find_errors(const Image& test, const Image& reference, double pixels_per_degree,
                 PixelOf&& pixel_of, std::vector<float>& largest) {
  const Seen a = look(test, pixels_per_degree, pixel_of);
  const Seen b = look(reference, pixels_per_degree, pixel_of);
  for (std::size_t i = 0; i < largest.size(); ++i) {
    const double edges = std::abs(a.features.edges.values[i] - b.features.edges.values[i]);
    const double points = std::abs(a.features.points.values[i] - b.features.points.values[i]);
    const double feature = std::pow(std::max(edges, points) / std::sqrt(2.0), qf);
    const double color = color_error(seen_color(a, i), seen_color(b, i));
    largest[i] = std::max(largest[i], static_cast<float>(std::pow(color, 1 - feature)));
  }
}

/// Radiance from 0 to a value whose square is finite.
double positive(float value) { return value > 0 ? std::min(double{value}, 1e30) : 0.0; }

double luminance_of(const float* c) {
  return 0.2126 * positive(c[0]) + 0.7152 * positive(c[1]) + 0.0722 * positive(c[2]);
}

// Narkowicz's fit of the ACES curve with an exposure of 0.6: (k0 x^2 + k1 x) / (k3 x^2 + k4 x +
// k5).
constexpr double k0 = 0.36 * 2.51, k1 = 0.6 * 0.03, k3 = 0.36 * 2.43, k4 = 0.6 * 0.59, k5 = 0.14;

double aces(double x) {
  return std::clamp((k0 * x * x + k1 * x) / (k3 * x * x + k4 * x + k5), 0.0, 1.0);
}

/// Where the curve reaches t.
double inverse_aces(double t) {
  const double a = k0 - t * k3, b = k1 - t * k4, c = -t * k5;
  return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
}

}  // namespace

FlipExposures flip_exposures(const Image& reference) {
  std::vector<double> values;
  for (std::size_t i = 0; i < reference.rgb.size(); i += 3) {
    values.push_back(luminance_of(&reference.rgb[i]));
  }
  if (values.empty()) return {};
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  // An image that is mostly black has no median to go by.
  constexpr double least = 1.2e-7;
  const double median = std::max(*middle, least);
  const double largest = std::max(*std::max_element(values.begin(), values.end()), least);
  const double wanted = inverse_aces(0.85);
  FlipExposures exposures{std::log2(wanted / largest), std::log2(wanted / median)};
  exposures.count = std::max(2, static_cast<int>(std::ceil(exposures.stop - exposures.start)));
  return exposures;
}

std::vector<float> ldr_flip(const Image& test, const Image& reference, const FlipView& view) {
  return flip_by_tiles(test, reference, view, [&](const Image& a, const Image& b) {
    std::vector<float> errors(a.rgb.size() / 3, 0.0f);
    const auto displayed = [](const float* c) {
      return Triple{std::min(positive(c[0]), 1.0), std::min(positive(c[1]), 1.0),
                    std::min(positive(c[2]), 1.0)};
    };
    find_errors(a, b, view.pixels_per_degree, displayed, errors);
    return errors;
  });
}

std::vector<float> hdr_flip(const Image& test, const Image& reference, const FlipView& view) {
  const FlipExposures exposures = flip_exposures(reference);
  return flip_by_tiles(test, reference, view, [&](const Image& a, const Image& b) {
    std::vector<float> errors(a.rgb.size() / 3, 0.0f);
    for (int i = 0; i < exposures.count; ++i) {
      const double stops =
          exposures.start + (exposures.stop - exposures.start) * i / (exposures.count - 1);
      const auto displayed = [scale = std::exp2(stops)](const float* c) {
        return Triple{aces(scale * positive(c[0])), aces(scale * positive(c[1])),
                      aces(scale * positive(c[2]))};
      };
      find_errors(a, b, view.pixels_per_degree, displayed, errors);
    }
    return errors;
  });
}

std::vector<float> flip_of(const Image& test, const Image& reference, bool is_hdr,
                           const ImageDifference& difference) {
  if (difference.differing_pixels == 0) return std::vector<float>(reference.rgb.size() / 3, 0.0f);
  return is_hdr ? hdr_flip(test, reference) : ldr_flip(test, reference);
}

double mean_of(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace pt
