// Indices of refraction by name.
#include <fmt/format.h>

#include <map>

#include "common/scene/load/mitsuba/surfaces/surfaces.h"
#include "common/scene/load/mitsuba/xml/values.h"

namespace pt::mitsuba {
namespace {

/// Names and values as in Mitsuba's documentation of `dielectric`.
const std::map<std::string_view, double>& dielectrics() {
  static const std::map<std::string_view, double> table = {
      {"vacuum", 1.0},      {"helium", 1.000036},        {"hydrogen", 1.000132},
      {"air", 1.000277},    {"carbon dioxide", 1.00045}, {"water", 1.3330},
      {"acetone", 1.36},    {"ethanol", 1.361},          {"carbon tetrachloride", 1.461},
      {"glycerol", 1.4729}, {"benzene", 1.501},          {"silicone oil", 1.52045},
      {"bromine", 1.661},   {"water ice", 1.31},         {"fused quartz", 1.458},
      {"pyrex", 1.470},     {"acrylic glass", 1.49},     {"polypropylene", 1.49},
      {"bk7", 1.5046},      {"sodium chloride", 1.544},  {"amber", 1.55},
      {"pet", 1.5750},      {"diamond", 2.419}};
  return table;
}

double ior_of(const Object& bsdf, std::string_view name, double fallback) {
  const Element* at = bsdf.find(name);
  if (!at) return fallback;
  const std::string& text = at->required("value");
  std::string lower;
  for (const char c : text) lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (const auto known = dielectrics().find(lower); known != dielectrics().end()) {
    return known->second;
  }
  const std::optional<double> number = parse_number(text);
  if (!number || !(*number > 0)) {
    fail(*at, fmt::format("{} is '{}'; expected a number above 0 or a name such as bk7 or air",
                          name, text));
  }
  return *number;
}

}  // namespace

float relative_ior(const Object& bsdf, std::string_view inside) {
  return static_cast<float>(ior_of(bsdf, "int_ior", dielectrics().at(inside)) /
                            ior_of(bsdf, "ext_ior", dielectrics().at("air")));
}

float outside_ior(const Object& bsdf) { return static_cast<float>(ior_of(bsdf, "ext_eta", 1.0)); }

}  // namespace pt::mitsuba
