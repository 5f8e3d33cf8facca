#include "common/light/sky/environment.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "common/error/error.h"

namespace pt {
namespace {

/// The luminance of linear sRGB (Rec. 709).
double luminance(const Color& c) {
  return 0.2126 * double{c.x} + 0.7152 * double{c.y} + 0.0722 * double{c.z};
}

void check_pixels(int width, int height, std::span<const Color> pixels) {
  if (width < 1 || height < 1 ||
      std::int64_t{width} * height > std::numeric_limits<std::int32_t>::max() ||
      static_cast<std::uint64_t>(std::int64_t{width} * height) != pixels.size()) {
    throw Error(
        fmt::format("environment of {} x {} and {} pixels: expected width x height pixels, "
                    "at least one and below 2^31",
                    width, height, pixels.size()));
  }
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Color& p = pixels[i];
    const float least = std::min({p.x, p.y, p.z});
    if (!(least >= 0.0f && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z))) {
      const auto w = static_cast<std::size_t>(width);
      throw Error(
          fmt::format("environment: pixel ({}, {}) is ({}, {}, {}), expected finite "
                      "radiances >= 0",
                      i % w, i / w, p.x, p.y, p.z));
    }
  }
}

/// `to_world` without its uniform scale and its translation.
Affine orthogonal(const Affine& to_world) {
  const float size = std::cbrt(std::fabs(to_world.determinant()));
  Affine result;
  for (int i = 0; i < 3; ++i) {
    result.row[i] = Vec4(Vec3(to_world.row[i]) / size, 0.0f);
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const float product = glm::dot(result.row[i], result.row[j]);
      if (!(std::fabs(product - (i == j ? 1.0f : 0.0f)) < 1e-3f)) {
        throw Error("environment: to_world shears or stretches, expected a rotation");
      }
    }
  }
  return result;
}

/// Luminance along a row, averaged over a column's width: 1/8 of either neighbour and 6/8 of the
/// column itself.
double row_luminance(int width, std::span<const Color> pixels, int x, int row) {
  const auto at = [&](int column) {
    return luminance(pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                            static_cast<std::size_t>(column)]);
  };
  return 0.125 * at((x + width - 1) % width) + 0.75 * at(x) + 0.125 * at((x + 1) % width);
}

/// The directions between two rows, theta from band * step to (band + 1) * step: the solid angle of
/// a full turn, and the mean of the way from the first row to the second.
struct Band {
  double solid_angle, mean;
};

/// Without cancellation in fine maps: with m the middle and d half of the step, the integral of
/// sin(m + x) is 2 sin m sin d, and that of x sin(m + x) is 2 cos m (sin d - d cos d).
Band measure_band(int band, int bands) {
  const double d = 0.5 * double{pi} / bands, m = (2 * band + 1) * d;
  // The series of sin d - d cos d, where the difference would lose digits.
  const double moment = d > 0.1 ? std::sin(d) - d * std::cos(d)
                                : d * d * d * (1.0 / 3 - d * d * (1.0 / 30 - d * d / 840));
  const double tilt = std::cos(m) * moment / (std::sin(m) * std::sin(d) * 2 * d);
  return {4 * double{pi} * std::sin(m) * std::sin(d), 0.5 + tilt};
}

}  // namespace

EnvironmentMap make_environment(int width, int height, std::span<const Color> pixels,
                                const Affine& to_world) {
  check_pixels(width, height, pixels);
  EnvironmentMap map;
  map.width = static_cast<std::uint32_t>(width);
  map.height = static_cast<std::uint32_t>(height);
  map.to_world = orthogonal(to_world);
  map.texels.resize(pixels.size());
  const int bands = static_cast<int>(map.view().bands());
  std::vector<float> weights(static_cast<std::size_t>(bands) * map.width);
  std::vector<double> band_power(static_cast<std::size_t>(bands));
  tbb::parallel_for(0, height, [&](int y) {
    const Band band = measure_band(std::min(y, bands - 1), bands);
    double power = 0;
    for (int x = 0; x < width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * map.width + static_cast<std::size_t>(x);
      map.texels[i] = {pixels[i], 0.0f};
      if (y >= bands) continue;
      const double here = row_luminance(width, pixels, x, y);
      const double next = row_luminance(width, pixels, x, std::min(y + 1, height - 1));
      const double brightness = here + band.mean * (next - here);
      map.texels[i].pdf = static_cast<float>(brightness);
      weights[i] = static_cast<float>(brightness * band.solid_angle / width);
      power += brightness * band.solid_angle / width;
    }
    if (y < bands) band_power[static_cast<std::size_t>(y)] = power;
  });
  double power = 0;
  for (const double band : band_power) power += band;
  map.average = static_cast<float>(power / (4 * double{pi}));
  tbb::parallel_for(0, bands, [&](int y) {
    for (std::size_t x = 0; x < map.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * map.width + x;
      EnvironmentTexel& texel = map.texels[i];
      texel.pdf = power > 0 ? static_cast<float>(texel.pdf / power) : 0.25f * inverse_pi;
      if (!(power > 0)) weights[i] = static_cast<float>(measure_band(y, bands).solid_angle);
    }
  });
  map.alias = build_alias_table(weights);
  return map;
}

}  // namespace pt
