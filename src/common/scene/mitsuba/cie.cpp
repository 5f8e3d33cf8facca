// Spectra to linear sRGB.
#include <algorithm>
#include <cmath>

#include "common/scene/mitsuba/spectra.h"

namespace pt::mitsuba {
namespace {

using DVec3 = glm::dvec3;

/// A Gaussian with different widths on its two sides; `left` and `right` are 1 / width.
double lobe(double x, double mean, double left, double right) {
  const double t = (x - mean) * (x < mean ? left : right);
  return std::exp(-0.5 * t * t);
}

/// The CIE 1931 colour matching functions: fits of Wyman, Sloan and Shirley 2013 ('Simple Analytic
/// Approximations to the CIE XYZ Color Matching Functions', JCGT 2:2), multi-lobe.
DVec3 observer(double nm) {
  return {1.056 * lobe(nm, 599.8, 0.0264, 0.0323) + 0.362 * lobe(nm, 442.0, 0.0624, 0.0374) -
              0.065 * lobe(nm, 501.1, 0.0490, 0.0382),
          0.821 * lobe(nm, 568.8, 0.0213, 0.0247) + 0.286 * lobe(nm, 530.9, 0.0613, 0.0322),
          1.217 * lobe(nm, 437.0, 0.0845, 0.0278) + 0.681 * lobe(nm, 459.0, 0.0385, 0.0725)};
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

/// CIE standard illuminant D65, relative, every 20 nm (ISO 11664-2).
const Samples& d65() {
  static const Samples samples = {
      {360, 46.64},  {380, 49.98},  {400, 82.75},  {420, 93.43},  {440, 104.86}, {460, 117.81},
      {480, 115.92}, {500, 109.35}, {520, 104.79}, {540, 104.41}, {560, 100.00}, {580, 95.79},
      {600, 90.01},  {620, 87.70},  {640, 83.70},  {660, 80.21},  {680, 78.28},  {700, 71.61},
      {720, 61.60},  {740, 75.09},  {760, 46.42},  {780, 63.38},  {800, 59.45},  {830, 60.31}};
  return samples;
}

DVec3 xyz_to_srgb(const DVec3& c) {  // IEC 61966-2-1
  return {3.2404542 * c.x - 1.5371385 * c.y - 0.4985314 * c.z,
          -0.9692660 * c.x + 1.8760108 * c.y + 0.0415560 * c.z,
          0.0556434 * c.x - 0.2040259 * c.y + 1.0572252 * c.z};
}

/// Linear sRGB of value(nm) * light(nm), where light alone has the luminance 1.
template <class Value, class Light>
DVec3 integrate(Value&& value, Light&& light) {
  DVec3 sum(0.0);
  double white = 0;
  for (double nm = 360; nm <= 830; nm += 1) {
    const DVec3 seen = light(nm) * observer(nm);
    sum += value(nm) * seen;
    white += seen.y;
  }
  return xyz_to_srgb(sum / white);
}

Color nonnegative(const DVec3& c) { return glm::max(Color(c), Color(0.0f)); }

}  // namespace

Color spectrum_to_rgb(const Samples& samples, Quantity quantity) {
  const auto value = [&](double nm) { return value_at(samples, nm); };
  if (quantity != Quantity::reflectance) {
    return nonnegative(integrate(value, [](double) { return 1.0; }));
  }
  const auto daylight = [](double nm) { return value_at(d65(), nm); };
  // Divided by what the fits make of white, so that white is white.
  const DVec3 white = integrate([](double) { return 1.0; }, daylight);
  return nonnegative(integrate(value, daylight) / white);
}

Color blackbody_to_rgb(double kelvin) {
  constexpr double h = 6.62607015e-34, c = 299792458.0, k = 1.380649e-23;
  const auto radiance = [&](double nm) {
    const double m = nm * 1e-9;
    return 2e-9 * h * c * c / (std::pow(m, 5) * std::expm1(h * c / (m * k * kelvin)));
  };
  return nonnegative(integrate(radiance, [](double) { return 1.0; }));
}

}  // namespace pt::mitsuba
