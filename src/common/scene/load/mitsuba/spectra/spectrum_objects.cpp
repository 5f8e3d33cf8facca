// Spectra that are plugins: <spectrum type="...">, and <texture> in their place.
#include <fmt/format.h>

#include <set>

#include "common/scene/load/mitsuba/spectra/spectra.h"
#include "common/scene/load/mitsuba/xml/values.h"

namespace pt::mitsuba {
namespace {

/// Samples at as many wavelengths.
Samples paired_samples(const Element& element, const std::vector<double>& wavelengths,
                       const std::vector<double>& values) {
  if (wavelengths.size() != values.size()) {
    fail(element, fmt::format("{} wavelengths and {} values; expected as many of both",
                              wavelengths.size(), values.size()));
  }
  Samples samples;
  for (std::size_t i = 0; i < values.size(); ++i) samples.emplace_back(wavelengths[i], values[i]);
  return sorted_samples(element, std::move(samples));
}

/// The first of two properties that the object has.
Color given_color(Context& context, const Object& object, const char* name, const char* other,
                  Quantity quantity, const Color& fallback) {
  const Element* element = object.find(name);
  if (!element) element = object.find(other);
  return element ? read_color(context, *element, quantity, fallback) : fallback;
}

std::vector<double> numbers_of(const Object& object, std::string_view name) {
  const Element* element = object.find(name);
  return element ? parse_numbers(*element, element->required("value")) : std::vector<double>();
}

/// Wavelengths at equal distances: `range`, or two numbers in the words of Mitsuba 3 or 2.
std::vector<double> regular_wavelengths(const Object& object, std::size_t count) {
  std::vector<double> range = numbers_of(object, "range");
  if (range.size() != 2) {
    range = {object.number("lambda_min").value_or(360), object.number("lambda_max").value_or(830)};
    range[0] = object.number("wavelength_min").value_or(range[0]);
    range[1] = object.number("wavelength_max").value_or(range[1]);
  }
  std::vector<double> wavelengths;
  for (std::size_t i = 0; i < count; ++i) {
    wavelengths.push_back(range[0] + (range[1] - range[0]) * static_cast<double>(i) /
                                         static_cast<double>(count - 1));
  }
  return wavelengths;
}

/// `regular` and `irregular`.
Color sampled_color(Context& context, const Object& object, Quantity quantity,
                    const Color& stand_in) {
  if (const Element* value = object.find("value")) {
    return read_color(context, *value, quantity, stand_in);
  }
  const std::vector<double> values = numbers_of(object, "values");
  if (values.size() < 2) {
    fail(object.element(),
         fmt::format("spectrum '{}': expected two values or more", object.type()));
  }
  const bool is_regular = object.type() == "regular";
  const std::vector<double> wavelengths =
      is_regular ? regular_wavelengths(object, values.size()) : numbers_of(object, "wavelengths");
  return samples_color(context, object.element(),
                       paired_samples(object.element(), wavelengths, values), quantity);
}

Color blackbody_object(const Object& object) {
  const double from = object.number("wavelength_min").value_or(360);
  const double to = object.number("wavelength_max").value_or(830);
  return blackbody_to_rgb(object.number("temperature").value_or(6500), from, to) *
         object.number("scale", 1.0f);
}

Color spectrum_object_color(Context& context, const Object& object, Quantity quantity,
                            const Color& stand_in) {
  const std::string type = object.type();
  const auto given = [&](const char* name, const char* other) {
    return given_color(context, object, name, other, Quantity::plain, Color(1.0f));
  };
  if (type == "d65") return given("color", "value") * object.number("scale", 1.0f);
  if (type == "blackbody") return blackbody_object(object);
  if (type == "regular" || type == "irregular") {
    return sampled_color(context, object, quantity, stand_in);
  }
  object.ignore({"wavelength_min", "wavelength_max", "lambda_min", "lambda_max", "unbounded"});
  if (type == "spectrum") return given_color(context, object, "value", "color", quantity, stand_in);
  if (type == "uniform" || type == "srgb" || type == "rgb" || type == "rawconstant") {
    return given("color", "value");
  }
  context.warn_once("spectrum " + type, object.element(),
                    fmt::format("spectrum '{}' is not supported: {} is used", type, stand_in.x));
  return stand_in;
}

}  // namespace

bool is_spectrum(const Object& object) {
  static const std::set<std::string_view> types = {"d65",     "uniform",     "srgb",
                                                   "rgb",     "rawconstant", "blackbody",
                                                   "regular", "irregular",   "spectrum"};
  return object.tag() == "spectrum" || (object.tag() == "texture" && types.contains(object.type()));
}

Color read_spectrum_object(Context& context, const Object& object, Quantity quantity,
                           const Color& stand_in) {
  const Color color = spectrum_object_color(context, object, quantity, stand_in);
  return bounded_color(context, object.element(), color, quantity);
}

}  // namespace pt::mitsuba
