// Colours of all kinds to linear sRGB.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "common/scene/load/files/importer.h"
#include "common/scene/load/files/text.h"
#include "common/scene/load/pbrt/surfaces/textures.h"
#include "common/scene/load/pbrt/syntax/parameters.h"
#include "common/scene/load/pbrt/syntax/tokens.h"

namespace pt::pbrt {
namespace {

float luminance_of(const Color& c) { return dot(c, Color(0.2126f, 0.7152f, 0.0722f)); }

/// For light: pbrt-v3 takes spectra as they are: a constant one of 1 has luminance 1.
Color of_earlier_version(const Color& color) {
  static const Color constant =
      spectrum_to_rgb({{360.0, 1.0}, {830.0, 1.0}}, Illuminant::equal_energy);
  return color / luminance_of(constant);
}

Color of_luminance_one(const Parameter& parameter, const Color& color) {
  const float y = luminance_of(color);
  if (y > 0.0f && std::isfinite(y)) return color / y;
  fail(parameter.place, "'{} {}' has no light that can be seen", parameter.type, parameter.name);
}

Color sampled(const Context& context, const Parameter& parameter,
              const std::vector<double>& numbers, Quantity quantity) {
  if (numbers.size() % 2 != 0 || numbers.empty()) {
    fail(parameter.place,
         "'spectrum {}' has {} numbers; expected pairs of wavelength (nm) and value",
         parameter.name, numbers.size());
  }
  Samples samples;
  for (std::size_t i = 0; i < numbers.size(); i += 2) {
    if (i > 0 && !(numbers[i] > numbers[i - 2])) {
      fail(parameter.place, "a spectrum whose wavelengths do not grow");
    }
    samples.emplace_back(numbers[i], numbers[i + 1]);
  }
  const bool emits = quantity == Quantity::illuminant;
  const Color color = spectrum_to_rgb(samples, emits ? Illuminant::equal_energy : Illuminant::d65);
  if (!emits) return color;
  return context.description.is_earlier ? of_earlier_version(color)
                                        : of_luminance_one(parameter, color);
}

/// Reads a file of lines "wavelength value"; # begins a comment.
std::vector<double> read_samples(Context& context, const Parameter& parameter) {
  const auto path = context.resolve(parameter.place, parameter.strings[0]);
  std::vector<double> numbers;
  try {
    const std::string content = read_source(path);
    std::string_view rest = content;
    while (!rest.empty()) {
      std::string_view line = rest.substr(0, rest.find('\n'));
      rest.remove_prefix(std::min(rest.size(), line.size() + 1));
      line = line.substr(0, line.find('#'));
      for (auto word = next_word(line); !word.empty(); word = next_word(line)) {
        numbers.push_back(pt::parse_number(word));
      }
    }
  } catch (const Error& error) {
    fail(parameter.place, "'{}' is no spectrum that is known by name and no file: {}",
         parameter.strings[0], error.what());
  }
  return numbers;
}

Color named(Context& context, const Parameter& parameter, Quantity quantity) {
  const std::string& name = parameter.strings[0];
  if (const auto illuminant = named_illuminant(name)) return *illuminant;
  if (const auto metal = named_metal(name)) return *metal;
  if (const auto glass = named_glass(name)) return Color(*glass);
  const std::string stem = std::filesystem::path(name).stem().string();
  // "spds/Cu.eta.spd" comes with pbrt-v3, not with scenes.
  const std::size_t dot = stem.find('.');
  if (dot != stem.npos && !exists(context.resolve(parameter.place, name))) {
    const auto metal = named_metal("metal-" + stem.substr(0, dot) + '-' + stem.substr(dot + 1));
    if (metal) return *metal;
  }
  return sampled(context, parameter, read_samples(context, parameter), quantity);
}

Color spectrum_of(Context& context, const Parameter& parameter, Quantity quantity) {
  if (parameter.strings.size() > 1) fail(parameter.place, "a spectrum of more than one name");
  if (!parameter.strings.empty()) return named(context, parameter, quantity);
  return sampled(context, parameter, parameter.numbers, quantity);
}

Color blackbody(const Context& context, const Parameter& p) {
  if (!(p.numbers[0] >= 100 && p.numbers[0] <= 1e6)) {
    fail(p.place, "blackbody {}; expected kelvins from 100 to 1e6", p.numbers[0]);
  }
  if (context.description.is_earlier) {
    // Its spectrum over its largest value, times a scale.
    const double scale = p.numbers.size() > 1 ? p.numbers[1] : 1.0;
    return static_cast<float>(scale / GlowingGas::y_integral) * radiance_of_gas(p.numbers[0]);
  }
  return of_luminance_one(p, blackbody_to_rgb(p.numbers[0]));
}

Color color_of(Context& context, const Parameter& p, Quantity quantity) {
  const auto check_count = [&](std::size_t count) {
    if (p.numbers.size() == count) return;
    fail(p.place, "'{} {}' has {} numbers; expected {}", p.type, p.name, p.numbers.size(), count);
  };
  if (p.type == "spectrum") return spectrum_of(context, p, quantity);
  if (p.type == "blackbody") {
    // With a scale in pbrt-v3.
    check_count(p.numbers.size() == 2 && context.description.is_earlier ? 2 : 1);
    return blackbody(context, p);
  }
  if (p.type == "xyz") {
    check_count(3);
    const glm::dvec3 xyz(p.numbers[0], p.numbers[1], p.numbers[2]);
    return glm::max(Color(glm::inverse(xyz_from_srgb()) * xyz), Color(0.0f));
  }
  if (p.type == "rgb" || p.type == "color") {
    check_count(3);
    const Color color(p.numbers[0], p.numbers[1], p.numbers[2]);
    for (int i = 0; i < 3; ++i) {
      if (!(color[i] >= 0.0f)) fail(p.place, "'rgb {}' with a negative number", p.name);
    }
    return to_srgb(color, p.space);
  }
  if (p.type == "float" || p.type == "integer") {
    check_count(1);
    context.reporter.warn_once(
        "grey " + p.name, p.place,
        "'{} {}' as a colour: grey is used; expected rgb, spectrum or blackbody", p.type, p.name);
    return Color(static_cast<float>(p.numbers[0]));
  }
  fail(p.place, "parameter '{}' is of type '{}'; expected rgb, spectrum or blackbody", p.name,
       p.type);
}

}  // namespace

Color read_color(Context& context, const Parameter& parameter, Quantity quantity) {
  Color color = color_of(context, parameter, quantity);
  for (int i = 0; i < 3; ++i) {
    if (!(color[i] >= 0.0f) || !std::isfinite(color[i])) {
      fail(parameter.place,
           "'{} {}' has the component {}; expected one that is finite and not negative",
           parameter.type, parameter.name, color[i]);
    }
    if (quantity == Quantity::albedo && color[i] > 1.0f) {
      context.reporter.warn_once("reflectance above 1", parameter.place,
                                 "'{} {}' above 1: 1 is used, for conservation of energy",
                                 parameter.type, parameter.name);
      color[i] = 1.0f;
    }
  }
  return color;
}

Color read_color(Context& context, const Parameters& parameters, std::string_view name,
                 const Color& fallback, Quantity quantity) {
  const Parameter* parameter = parameters.find(name);
  Color color = fallback;
  if (!parameter) return color;
  context.reporter.attempt(fmt::format("'{}' of {}", name, parameters.what()),
                           "is as if it was not given",
                           [&] { color = read_color(context, *parameter, quantity); });
  return color;
}

float read_index(Context& context, const Parameters& parameters, std::string_view name,
                 float fallback) {
  const Parameter* p = parameters.find(name, {"float", "integer", "spectrum"});
  if (!p) return fallback;
  const float index =
      p->type == "spectrum"
          ? mean(read_color(context, parameters, name, Color(fallback), Quantity::unbounded))
          : parameters.number(name, fallback);
  if (p->type == "spectrum") {
    context.reporter.warn_once(
        "dispersion", p->place,
        "'spectrum {}': the index of refraction {} is used for all wavelengths", name, index);
  }
  if (index > 0.0f) return index;
  fail(p->place, "'{} {}' of {}; expected one above 0", p->type, name, index);
}

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
         blackbody_to_rgb(kelvins);
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

std::vector<Color> read_gas_light(const Parameters& parameters, const FileLocation& place,
                                  const std::vector<float>& temperatures) {
  const float offset =
      parameters.number("temperatureoffset", parameters.number("temperaturecutoff", 0.0f));
  const float factor = parameters.number("temperaturescale", 1.0f);
  const auto kelvins = [&](float temperature) { return (temperature - offset) * factor; };
  float hottest = 0.0f;
  for (const float temperature : temperatures) {
    const float t = kelvins(temperature);
    if (!std::isfinite(t)) fail(place, "a temperature of {} K", t);
    hottest = std::max(hottest, t);
  }
  const GlowingGas gas(hottest);
  std::vector<Color> light(temperatures.size());
  tbb::parallel_for(std::size_t{0}, light.size(),
                    [&](std::size_t i) { light[i] = gas.radiance(kelvins(temperatures[i])); });
  return light;
}

}  // namespace pt::pbrt
