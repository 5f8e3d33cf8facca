#include <algorithm>
#include <array>
#include <cmath>

#include "common/scene/load/files/importer.h"

namespace pt {
namespace {

using DVec3 = glm::dvec3;

constexpr int cie_rows = 95;
constexpr double cie_first_nm = 360, cie_last_nm = 830, cie_step_nm = 5;

/// Colour matching functions and the relative power of the illuminant D65.
struct CieRow {
  DVec3 xyz;
  double d65;
};

const std::array<CieRow, cie_rows> cie_table = {{
#include <tables/cie1931.inc>
}};

/// Linear between the table's rows; 360 <= nm <= 830.
CieRow row_at(double nm) {
  const double x = (nm - cie_first_nm) / cie_step_nm;
  const int below = std::min(static_cast<int>(x), cie_rows - 2);
  const CieRow &a = cie_table[static_cast<std::size_t>(below)],
               &b = cie_table[static_cast<std::size_t>(below) + 1];
  const double t = x - below;
  return {a.xyz + t * (b.xyz - a.xyz), a.d65 + t * (b.d65 - a.d65)};
}

/// Linear between samples, zero outside of them.
double value_at(const Samples& samples, double nm) {
  if (samples.empty() || nm < samples.front().first || nm > samples.back().first) return 0;
  const auto after = std::upper_bound(samples.begin(), samples.end(), nm,
                                      [](double x, const auto& s) { return x < s.first; });
  if (after == samples.begin()) return samples.front().second;
  if (after == samples.end()) return samples.back().second;
  const auto before = after - 1;
  const double t = (nm - before->first) / (after->first - before->first);
  return before->second + t * (after->second - before->second);
}

DVec3 xyz_to_srgb(const DVec3& c) {  // ITU-R BT.709
  return {3.240479 * c.x - 1.537150 * c.y - 0.498535 * c.z,
          -0.969256 * c.x + 1.875991 * c.y + 0.041556 * c.z,
          0.055648 * c.x - 0.204043 * c.y + 1.057311 * c.z};
}

/// Linear sRGB of a function of nm in an illuminant. The sum is Mitsuba's, a thousandth less than
/// the integral, so that a file has the same colours in both.
template <class Value>
DVec3 integrate(Value&& value, Illuminant illuminant) {
  constexpr int steps = 1000;
  constexpr double d65_norm = 98.99741751876255, luminance_norm = 106.7502593994140625;
  DVec3 sum(0.0);
  for (int i = 0; i < steps; ++i) {
    const double nm = cie_first_nm + (cie_last_nm - cie_first_nm) * i / (steps - 1);
    const CieRow row = row_at(nm);
    sum += value(nm) * (illuminant == Illuminant::d65 ? row.d65 / d65_norm : 1.0) * row.xyz;
  }
  return xyz_to_srgb(sum * ((cie_last_nm - cie_first_nm) / (luminance_norm * steps)));
}

Color nonnegative(const DVec3& c) { return glm::max(Color(c), Color(0.0f)); }

}  // namespace

Color spectrum_to_rgb(const Samples& samples, Illuminant illuminant) {
  return nonnegative(integrate([&](double nm) { return value_at(samples, nm); }, illuminant));
}

Color blackbody_to_rgb(double kelvin, double from_nm, double to_nm) {
  constexpr double h = 6.62607015e-34, c = 299792458.0, k = 1.380649e-23;
  const auto radiance = [&](double nm) {
    if (nm < from_nm || nm > to_nm) return 0.0;
    const double m = nm * 1e-9;
    return 2e-9 * h * c * c / (std::pow(m, 5) * std::expm1(h * c / (m * k * kelvin)));
  };
  return nonnegative(integrate(radiance, Illuminant::equal_energy));
}

}  // namespace pt
