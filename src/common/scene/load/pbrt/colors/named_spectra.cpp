#include "common/scene/load/pbrt/colors/named_spectra.h"

#include <algorithm>
#include <array>

#include "common/scene/load/mitsuba/surfaces/conductors.h"
#include "common/scene/load/pbrt/syntax/color_space.h"

namespace pt::pbrt {
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

/// Of the makers' data sheets (n_d).
constexpr std::array<Glass, 7> glasses = {{{"glass-BK7", 1.5168f},
                                           {"glass-BAF10", 1.67003f},
                                           {"glass-FK51A", 1.48656f},
                                           {"glass-LASF9", 1.85025f},
                                           {"glass-F5", 1.6727f},
                                           {"glass-F10", 1.72828f},
                                           {"glass-F11", 1.78472f}}};

/// Brass, which the table of Mitsuba's metals lacks: Querry 1985, in the same way to linear sRGB.
const Color brass_eta(0.444f, 0.527f, 1.094f), brass_k(3.695f, 2.765f, 1.829f);

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
  if (name == "CuZn") return is_eta ? brass_eta : brass_k;
  const auto& metals = mitsuba::conductors;
  const auto found = std::ranges::find(metals, name, &mitsuba::ConductorIndex::name);
  if (name == "none" || found == metals.end()) return std::nullopt;
  return is_eta ? found->eta : found->k;
}

std::optional<float> named_glass(std::string_view name) {
  const auto found = std::ranges::find(glasses, name, &Glass::name);
  if (found == glasses.end()) return std::nullopt;
  return found->index;
}

}  // namespace pt::pbrt
