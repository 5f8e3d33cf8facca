// Colours and spectra, in elements and as plugins, to linear sRGB.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>

#include "common/image/tone_mapping.h"
#include "common/scene/load/files/whole_file.h"
#include "common/scene/load/mitsuba/surfaces/textures.h"
#include "common/scene/load/mitsuba/xml/elements.h"

namespace pt::mitsuba {

Samples sorted_samples(const Element& element, Samples samples) {
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (!(samples[i].first > samples[i - 1].first)) {
      fail(element, "<spectrum>: expected wavelengths in ascending order");
    }
  }
  return samples;
}

Color samples_color(Context& context, const Element& element, const Samples& samples,
                    Quantity quantity) {
  context.warn_once(
      "spectrum", element,
      "<spectrum> of wavelengths: linear sRGB is used, as the CIE 1931 observer sees it");
  return spectrum_to_rgb(
      samples, quantity == Quantity::emission ? Illuminant::equal_energy : Illuminant::d65);
}

namespace {

Color decoded(const Color& c) {
  return {srgb_curve.decode(c.x), srgb_curve.decode(c.y), srgb_curve.decode(c.z)};
}

/// #rrggbb, in the sRGB curve as on the web.
Color hex_color(const Element& element, const std::string& text) {
  std::uint32_t value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data() + 1, end, value, 16);
  if (text.size() != 7 || stop != end || error != std::errc()) {
    fail(element, "the colour '{}'; expected #rrggbb", text);
  }
  const Color bytes(value >> 16, value >> 8 & 255, value & 255);
  return decoded(bytes / 255.0f);
}

Color rgb_color(const Element& element) {
  if (!element.attribute("value") && element.attribute("x")) return vector_attributes(element, 0.0);
  const std::string& text = element.required("value");
  if (!text.empty() && text[0] == '#') return hex_color(element, text);
  const std::vector<double> v = parse_numbers(element, text);
  if (v.size() != 1 && v.size() != 3) {
    fail(element, "the colour '{}'; expected one or three numbers", text);
  }
  const Color color = v.size() == 1 ? Color(static_cast<float>(v[0])) : Color(v[0], v[1], v[2]);
  return element.tag == "srgb" ? decoded(color) : color;
}

/// "wavelength:value, ..."
Samples listed_samples(const Element& element, std::string text) {
  for (char& c : text) {
    if (c == ':') c = ' ';
  }
  const std::vector<double> v = parse_numbers(element, text);
  if (v.size() % 2 != 0) fail(element, "<spectrum>: expected pairs wavelength:value");
  Samples samples;
  for (std::size_t i = 0; i < v.size(); i += 2) samples.emplace_back(v[i], v[i + 1]);
  return sorted_samples(element, std::move(samples));
}

/// A file of lines "wavelength value"; # begins a comment. None where it cannot be read.
std::optional<Samples> sample_file(Context& context, const Element& element) {
  const std::filesystem::path path = context.resolve(element, element.required("filename"));
  std::string text;
  try {
    text = WholeFile(path).bytes();
  } catch (const Error& error) {
    context.warn_unreadable(
        element, fmt::format("cannot read the spectrum {}: {}", path.string(), error.what()),
        "what is without it is used");
    return std::nullopt;
  }
  std::istringstream file(text);
  std::string line, all;
  while (std::getline(file, line)) all += line.substr(0, line.find('#')) + " ";
  return listed_samples(element, std::move(all));
}

Color spectrum_color(Context& context, const Element& element, Quantity quantity,
                     const Color& stand_in) {
  const std::string* text = element.attribute("value");
  if (text && text->find(':') == text->npos) {
    const Color color = rgb_color(element);
    // Mitsuba 3 makes a constant emission spectrum the colour of equal energy, 0.x made it grey.
    const bool equal_energy = context.modern && quantity == Quantity::emission;
    return equal_energy ? color * Color(1.20479f, 0.948293f, 0.908916f) : color;
  }
  const std::optional<Samples> samples =
      text ? listed_samples(element, *text) : sample_file(context, element);
  return samples ? samples_color(context, element, *samples, quantity) : stand_in;
}

/// The temperature may have the unit of 0.x: "5000K".
Color blackbody_color(const Element& element) {
  std::string text = element.required("temperature");
  if (!text.empty() && (text.back() == 'K' || text.back() == 'k')) text.pop_back();
  const std::optional<double> kelvin = parse_number(text);
  if (!kelvin || !(*kelvin > 0)) {
    fail(element, "temperature '{}'; expected kelvins above 0", text);
  }
  return blackbody_to_rgb(*kelvin) * static_cast<float>(number_attribute(element, "scale", 1.0));
}

Color color_of(Context& context, const Element& element, Quantity quantity, const Color& stand_in) {
  static const std::set<std::string_view> tags = {"rgb",     "srgb",   "float",
                                                  "integer", "vector", "point"};
  if (element.tag == "spectrum") return spectrum_color(context, element, quantity, stand_in);
  if (element.tag == "blackbody") return blackbody_color(element);
  if (tags.contains(element.tag)) return rgb_color(element);
  fail(element, "a <{}>; expected a colour: <rgb>, <spectrum> or <float>", element.tag);
}

}  // namespace

Color bounded_color(Context& context, const Element& element, Color color, Quantity quantity) {
  const bool is_rgb = element.tag == "rgb" || element.tag == "srgb";
  for (int i = 0; i < 3; ++i) {
    if (!std::isfinite(color[i]) ||
        (color[i] < 0.0f && is_rgb && quantity == Quantity::reflectance)) {
      fail(element, "a colour with the component {}; expected one that is finite and not negative",
           color[i]);
    }
    if (color[i] < 0.0f) {
      const bool is_index = quantity == Quantity::index_of_refraction;
      context.warn_once(is_index ? "negative index" : "negative color", element,
                        "a negative component of {}: 0 is used",
                        is_index ? "an index of refraction" : "a colour");
      color[i] = 0.0f;
    }
    if (quantity == Quantity::reflectance && color[i] > 1.0f) {
      context.warn_once("reflectance above 1", element,
                        "a reflectance above 1: 1 is used, for conservation of energy");
      color[i] = 1.0f;
    }
  }
  return color;
}

Color read_color(Context& context, const Element& element, Quantity quantity,
                 const Color& stand_in) {
  return bounded_color(context, element, color_of(context, element, quantity, stand_in), quantity);
}

namespace {

// Spectra that are plugins: <spectrum type="...">, and <texture> in their place.

/// Samples at as many wavelengths.
Samples paired_samples(const Element& element, const std::vector<double>& wavelengths,
                       const std::vector<double>& values) {
  if (wavelengths.size() != values.size()) {
    fail(element, "{} wavelengths and {} values; expected as many of both", wavelengths.size(),
         values.size());
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
    fail(object.element(), "spectrum '{}': expected two values or more", object.type());
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
                    "spectrum '{}' is not supported: {} is used", type, stand_in.x);
  return stand_in;
}

}  // namespace

const std::vector<std::string>& spectrum_types() {
  static const std::vector<std::string> types = {"d65",     "uniform",     "srgb",
                                                 "rgb",     "rawconstant", "blackbody",
                                                 "regular", "irregular",   "spectrum"};
  return types;
}

bool is_spectrum(const Object& object) {
  return object.tag() == "spectrum" ||
         (object.tag() == "texture" && std::ranges::count(spectrum_types(), object.type()) > 0);
}

Color read_spectrum_object(Context& context, const Object& object, Quantity quantity,
                           const Color& stand_in) {
  const Color color = spectrum_object_color(context, object, quantity, stand_in);
  return bounded_color(context, object.element(), color, quantity);
}

}  // namespace pt::mitsuba
