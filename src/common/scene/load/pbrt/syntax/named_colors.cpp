// Colour spaces and spectra that pbrt knows by name.
#include <algorithm>
#include <array>

#include "common/scene/load/pbrt/syntax/parameters.h"

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

namespace {

struct Illuminant {
  std::string_view name;
  double x, y;
};

/// Chromaticities for the 2-degree observer: CIE 15:2004, tables T.3 and T.7; SMPTE ST 2065-1.
constexpr std::array<Illuminant, 16> illuminants = {{
    {"stdillum-A", 0.44758, 0.40745},
    {"stdillum-D50", 0.34567, 0.35851},
    {"stdillum-D65", 0.31272, 0.32903},
    {"stdillum-F1", 0.3131, 0.3371},
    {"stdillum-F2", 0.3721, 0.3751},
    {"stdillum-F3", 0.4091, 0.3941},
    {"stdillum-F4", 0.4402, 0.4031},
    {"stdillum-F5", 0.3138, 0.3452},
    {"stdillum-F6", 0.3779, 0.3882},
    {"stdillum-F7", 0.3129, 0.3292},
    {"stdillum-F8", 0.3458, 0.3586},
    {"stdillum-F9", 0.3741, 0.3727},
    {"stdillum-F10", 0.3458, 0.3588},
    {"stdillum-F11", 0.3805, 0.3769},
    {"stdillum-F12", 0.4370, 0.4042},
    {"illum-acesD60", 0.32168, 0.33767},
}};

struct Glass {
  std::string_view name;
  float index;
};

/// n_d, from the makers' data sheets.
constexpr std::array<Glass, 7> glasses = {{{"glass-BK7", 1.5168f},
                                           {"glass-BAF10", 1.67003f},
                                           {"glass-FK51A", 1.48656f},
                                           {"glass-LASF9", 1.85025f},
                                           {"glass-F5", 1.6727f},
                                           {"glass-F10", 1.72828f},
                                           {"glass-F11", 1.78472f}}};

struct Metal {
  std::string_view name;
  Color eta, k;
};

/// pbrt's spectra in daylight, as the CIE 1931 observer sees them (spectrum_to_rgb). What the
/// metals reflect along the normal is within 0.022 of their spectra's sRGB (gold's red, which is
/// 1.02, within 0.05). Mitsuba's numbers are those in light of equal energy.
const std::array<Metal, 7> metals = {{
    {"Ag", {0.1283f, 0.1234f, 0.1507f}, {4.0607f, 3.2825f, 2.3889f}},
    {"Al", {1.4060f, 0.9256f, 0.5834f}, {7.7324f, 6.5950f, 5.3540f}},
    {"Au", {0.0799f, 0.4047f, 1.5590f}, {3.3867f, 2.5007f, 1.7689f}},
    {"Cu", {0.1051f, 0.9768f, 1.2032f}, {3.2702f, 2.5896f, 2.3663f}},
    {"CuZn", {0.4180f, 0.5195f, 1.1217f}, {3.6639f, 2.6776f, 1.7693f}},
    {"MgO", {1.7319f, 1.7390f, 1.7514f}, Color(0.0f)},
    {"TiO2", {2.8575f, 2.9532f, 3.1817f}, {0.0001f, 0.0f, 0.0006f}},
}};

}  // namespace

std::optional<Color> named_illuminant(std::string_view name) {
  const auto found = std::ranges::find(illuminants, name, &Illuminant::name);
  if (found == illuminants.end()) return std::nullopt;
  return srgb_of_chromaticity(found->x, found->y);
}

std::optional<Color> named_metal(std::string_view name) {
  if (!name.starts_with("metal-")) return std::nullopt;
  name.remove_prefix(6);
  const bool is_eta = name.ends_with("-eta");
  if (!is_eta && !name.ends_with("-k")) return std::nullopt;
  name.remove_suffix(is_eta ? 4 : 2);
  const auto found = std::ranges::find(metals, name, &Metal::name);
  if (found == metals.end()) return std::nullopt;
  return is_eta ? found->eta : found->k;
}

std::optional<float> named_glass(std::string_view name) {
  const auto found = std::ranges::find(glasses, name, &Glass::name);
  if (found == glasses.end()) return std::nullopt;
  return found->index;
}

}  // namespace pt::pbrt
