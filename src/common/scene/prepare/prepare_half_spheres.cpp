#include "common/scene/prepare/prepare_half_spheres.h"

#include <algorithm>

#include "common/accel/scan_halves.h"

namespace pt {
namespace {

constexpr double u = half_float_rounding;
// Largest distance of the scaled spheres from their centre: squared, it is far from both ends of
// halves.
constexpr double extent_max = 16.0;
constexpr double scale_log2_max = 120.0;  // of a float
// Times the median extent: what is larger is always a candidate.
constexpr double large_extent = 8.0;

double extent_of(const Sphere& s) {
  return glm::length(glm::dvec3(s.center)) + std::sqrt(static_cast<double>(s.radius_squared));
}

/// The extent of most: beyond are those that are always candidates.
double limit_of(std::span<const Sphere> spheres) {
  std::vector<double> extents;
  for (const Sphere& s : spheres) {
    const double extent = extent_of(s);
    if (std::isfinite(extent)) extents.push_back(extent);
  }
  if (extents.empty()) return 0.0;
  const auto middle = extents.begin() + static_cast<std::ptrdiff_t>(extents.size() / 2);
  std::nth_element(extents.begin(), middle, extents.end());
  return large_extent * *middle;
}

std::uint16_t round_up(double x) {
  const std::uint16_t half = to_half(x);
  return from_half(half) < x ? half + 1 : half;  // x > 0
}

/// S above.
double widened_square(const glm::dvec3& c, const glm::dvec3& rounded, double radius) {
  const double e =
      glm::length(c - rounded) +
      1.01 * u *
          (2.0 * glm::length(c) + glm::length(glm::dvec2(c)) + std::abs(c.x) + 4.0 * radius) +
      0x1p-19;
  const double wide = radius + std::sqrt(2.0) * e;
  return (wide * wide + 0x1p-24) / (1.0 - u);
}

/// The power of two that brings what is not too large to extent_max at most, more than half of it.
float scale_of(std::span<const Sphere> spheres, double limit) {
  double extent = 0.0;
  for (const Sphere& s : spheres) {
    const double e = extent_of(s);
    if (e <= limit) extent = std::max(extent, e);
  }
  if (!(extent > 0.0)) return 1.0f;
  const double log2 = std::floor(std::log2(extent_max / extent));
  return static_cast<float>(std::exp2(std::min(log2, scale_log2_max)));
}

struct HalfSphere {
  std::uint16_t center[3] = {0, 0, 0}, radius_squared = 0x7c00;  // infinite: always a candidate
};

HalfSphere convert(const Sphere& sphere, double scale) {
  HalfSphere half;
  const glm::dvec3 c = scale * glm::dvec3(sphere.center);
  glm::dvec3 rounded;
  for (int axis = 0; axis < 3; ++axis) {
    half.center[axis] = to_half(c[axis]);
    rounded[axis] = from_half(half.center[axis]);
  }
  const double radius = scale * std::sqrt(static_cast<double>(sphere.radius_squared));
  half.radius_squared = round_up(widened_square(c, rounded, radius));
  return half;
}

void store(HalfSpheres& group, int byte, const HalfSphere& sphere) {
  const auto put = [&](std::uint32_t(&words)[2], std::uint16_t half) {
    const int shift = 16 * (byte % 2);
    std::uint32_t& word = words[byte / 2];
    word = (word & ~(0xffffu << shift)) | std::uint32_t{half} << shift;
  };
  put(group.x, sphere.center[0]), put(group.y, sphere.center[1]), put(group.z, sphere.center[2]);
  put(group.radius_squared, sphere.radius_squared);
}

}  // namespace

HalfScan prepare_half_spheres(std::span<const Sphere> spheres) {
  const double limit = limit_of(spheres);
  HalfScan scan;
  scan.scale = scale_of(spheres, limit);
  constexpr HalfSpheres none{{}, {}, {}, {0xfc00fc00u, 0xfc00fc00u}};  // of radius -infinity
  scan.groups.assign((spheres.size() + HalfSpheres::count - 1) / HalfSpheres::count, none);
  const auto groups = static_cast<std::uint32_t>(scan.groups.size());
  for (std::uint32_t i = 0; i < spheres.size(); ++i) {
    const bool is_large = !(extent_of(spheres[i]) <= limit);
    const HalfIndex index = half_index(i, groups);
    store(scan.groups[index.group], index.byte,
          is_large ? HalfSphere{} : convert(spheres[i], scan.scale));
  }
  return scan;
}

}  // namespace pt
