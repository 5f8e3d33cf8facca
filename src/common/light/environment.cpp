#include "common/light/environment.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>

#include "common/error.h"

namespace pt {
namespace {

/// Of linear sRGB (Rec. 709).
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

/// Luminance of the interpolated map, averaged over texel (x, y): along each axis 1/8 of either
/// neighbour and 6/8 of the texel.
double average_luminance(int width, int height, std::span<const Color> pixels, int x, int y) {
  constexpr double share[3] = {0.125, 0.75, 0.125};
  double sum = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    const int row = std::clamp(y + dy, 0, height - 1);
    for (int dx = -1; dx <= 1; ++dx) {
      const int column = (x + dx + width) % width;
      const std::size_t i = static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                            static_cast<std::size_t>(column);
      sum += share[dx + 1] * share[dy + 1] * luminance(pixels[i]);
    }
  }
  return sum;
}

/// Solid angle of each texel of a row: 2 pi (cos a - cos b) / width, without cancellation.
double texel_solid_angle(int width, int height, int row) {
  const double step = double{pi} / height;
  return 4 * double{pi} / width * std::sin((row + 0.5) * step) * std::sin(0.5 * step);
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
  std::vector<float> weights(pixels.size());
  std::vector<double> row_power(map.height);
  tbb::parallel_for(0, height, [&](int y) {
    const double solid_angle = texel_solid_angle(width, height, y);
    double power = 0;
    for (int x = 0; x < width; ++x) {
      const double brightness = average_luminance(width, height, pixels, x, y);
      const std::size_t i = static_cast<std::size_t>(y) * map.width + static_cast<std::size_t>(x);
      map.texels[i] = {pixels[i], static_cast<float>(brightness)};
      weights[i] = static_cast<float>(brightness * solid_angle);
      power += brightness * solid_angle;
    }
    row_power[static_cast<std::size_t>(y)] = power;
  });
  double power = 0;
  for (const double row : row_power) power += row;
  map.average = static_cast<float>(power / (4 * double{pi}));
  tbb::parallel_for(0, height, [&](int y) {
    for (std::size_t x = 0; x < map.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * map.width + x;
      EnvironmentTexel& texel = map.texels[i];
      texel.pdf = power > 0 ? static_cast<float>(texel.pdf / power) : 0.25f * inverse_pi;
      if (!(power > 0)) weights[i] = static_cast<float>(texel_solid_angle(width, height, y));
    }
  });
  map.alias = build_alias_table(weights);
  return map;
}

}  // namespace pt
