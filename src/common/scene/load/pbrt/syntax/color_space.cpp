#include "common/scene/load/pbrt/syntax/color_space.h"

#include <array>

namespace pt::pbrt {
namespace {

using DVec2 = glm::dvec2;
using DVec3 = glm::dvec3;
using DMat3 = glm::dmat3;

/// Chromaticities of the primaries and of white.
struct Primaries {
  std::string_view name;
  DVec2 red, green, blue, white;
};

constexpr DVec2 d65(0.3127, 0.3290);

/// By ColorSpace: IEC 61966-2-1, SMPTE EG 432-1 (with D65), ITU-R BT.2020, SMPTE ST 2065-1.
const std::array<Primaries, 4> spaces = {{
    {"srgb", {0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, d65},
    {"dci-p3", {0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}, d65},
    {"rec2020", {0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, d65},
    {"aces2065-1", {0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.0770}, {0.32168, 0.33767}},
}};

DVec3 xyz_of(const DVec2& xy) { return {xy.x / xy.y, 1.0, (1.0 - xy.x - xy.y) / xy.y}; }

DMat3 xyz_from_rgb(const Primaries& p) {
  const DMat3 columns(xyz_of(p.red), xyz_of(p.green), xyz_of(p.blue));
  const DVec3 scale = glm::inverse(columns) * xyz_of(p.white);
  return {columns[0] * scale.x, columns[1] * scale.y, columns[2] * scale.z};
}

Color srgb_of_xyz(const DVec3& xyz) {
  return glm::max(Color(glm::inverse(xyz_from_rgb(spaces[0])) * xyz), Color(0.0f));
}

}  // namespace

std::optional<ColorSpace> color_space_named(std::string_view name) {
  for (std::size_t i = 0; i < spaces.size(); ++i) {
    if (spaces[i].name == name) return static_cast<ColorSpace>(i);
  }
  return std::nullopt;
}

DMat3 xyz_from_srgb() { return xyz_from_rgb(spaces[0]); }

Color to_srgb(const Color& color, ColorSpace space) {
  if (space == ColorSpace::srgb) return color;
  return srgb_of_xyz(xyz_from_rgb(spaces[static_cast<std::size_t>(space)]) * DVec3(color));
}

Color srgb_of_chromaticity(double x, double y) { return srgb_of_xyz(xyz_of({x, y})); }

}  // namespace pt::pbrt
