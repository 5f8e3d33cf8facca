#include "common/scene/load/pbrt/colors/glowing_gas.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "common/scene/load/mitsuba/spectra/spectra.h"

namespace pt::pbrt {
namespace {

constexpr float coldest = 100.0f;    // kelvins
constexpr float hottest_max = 1e6f;  // hotter light has the same colour
constexpr int steps = 1024;

/// Planck's law at the wavelength of its maximum, by that law and Wien's, W / (m^2 sr nm).
double peak_radiance(double kelvins) {
  constexpr double h = 6.62607015e-34, c = 299792458.0, k = 1.380649e-23, x = 4.965114231744276;
  const double l = h * c / (x * k * kelvins);
  return 2e-9 * h * c * c / (std::pow(l, 5) * std::expm1(x));
}

}  // namespace

Color radiance_of_gas(double kelvins) {
  return static_cast<float>(GlowingGas::y_integral / peak_radiance(kelvins)) *
         mitsuba::blackbody_to_rgb(kelvins);
}

GlowingGas::GlowingGas(float hottest_kelvins) {
  const float hottest = std::clamp(hottest_kelvins, 1.01f * coldest, hottest_max);
  step_ = std::log(hottest / coldest) / steps;
  table_.reserve(steps + 1);
  for (int i = 0; i <= steps; ++i) {
    const double kelvins = double{coldest} * std::exp(double{step_} * i);
    table_.push_back(radiance_of_gas(kelvins));
  }
}

Color GlowingGas::radiance(float kelvins) const {
  if (!(kelvins > coldest)) return Color(0.0f);
  const float x = std::min(std::log(kelvins / coldest) / step_, static_cast<float>(steps));
  const int below = std::min(static_cast<int>(x), steps - 1);
  const Color &a = table_[static_cast<std::size_t>(below)],
              &b = table_[static_cast<std::size_t>(below) + 1];
  return a + (x - static_cast<float>(below)) * (b - a);
}

std::vector<Color> read_gas_light(const Parameters& parameters, const Place& place,
                                  const std::vector<float>& temperatures) {
  const float offset =
      parameters.number("temperatureoffset", parameters.number("temperaturecutoff", 0.0f));
  const float factor = parameters.number("temperaturescale", 1.0f);
  const auto kelvins = [&](float temperature) { return (temperature - offset) * factor; };
  float hottest = 0.0f;
  for (const float temperature : temperatures) {
    const float t = kelvins(temperature);
    if (!std::isfinite(t)) fail(place, fmt::format("a temperature of {} K", t));
    hottest = std::max(hottest, t);
  }
  const GlowingGas gas(hottest);
  std::vector<Color> light(temperatures.size());
  tbb::parallel_for(std::size_t{0}, light.size(),
                    [&](std::size_t i) { light[i] = gas.radiance(kelvins(temperatures[i])); });
  return light;
}

}  // namespace pt::pbrt
