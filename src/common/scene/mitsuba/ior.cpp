// Indices of refraction by name, and reflectances of metals.
#include <fmt/format.h>

#include <map>

#include "common/scene/mitsuba/surfaces.h"
#include "common/scene/mitsuba/values.h"

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

/// Reflectance at normal incidence in linear sRGB: measured by us with Mitsuba 3.9.1's `conductor`
/// (variant scalar_rgb), whose n and k are those of Palik, SOPRA and others.
const std::map<std::string_view, Color>& metals() {
  static const std::map<std::string_view, Color> table = {
      {"none", Color(1.0f)},
      {"Ag", {0.974801f, 0.957536f, 0.906259f}},
      {"Al", {0.928045f, 0.917801f, 0.918906f}},
      {"Au", {0.966679f, 0.802010f, 0.324121f}},
      {"Be", {0.597548f, 0.520603f, 0.506159f}},
      {"Cr", {0.687554f, 0.649068f, 0.686961f}},
      {"Cu", {0.952016f, 0.619787f, 0.510554f}},
      {"Hg", {0.814004f, 0.770216f, 0.763054f}},
      {"Ir", {0.742648f, 0.680169f, 0.630799f}},
      {"Li", {0.924785f, 0.884434f, 0.793263f}},
      {"Mo", {0.618205f, 0.561808f, 0.540856f}},
      {"Na_palik", {0.978536f, 0.959741f, 0.931527f}},
      {"Nb", {0.564048f, 0.489453f, 0.473065f}},
      {"Rh", {0.824266f, 0.754418f, 0.721626f}},
      {"Ta", {0.456480f, 0.341913f, 0.379942f}},
      {"Te", {0.635040f, 0.578091f, 0.561691f}},
      {"TiC", {0.548156f, 0.439682f, 0.411572f}},
      {"TiN", {0.640859f, 0.452259f, 0.197557f}},
      {"VC", {0.529685f, 0.417942f, 0.379775f}},
      {"W", {0.574618f, 0.477757f, 0.433055f}},
      {"a-C", {0.279440f, 0.194037f, 0.169086f}}};
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

Color named_metal(Context& context, const Object& bsdf) {
  const std::string name = bsdf.text("material", context.modern ? "none" : "Cu");
  const auto metal = metals().find(name);
  if (metal != metals().end()) return metal->second;
  context.warn_once("metal " + name, bsdf.element(),
                    fmt::format("the conductor '{}' is not known: aluminium is used", name));
  return metals().at("Al");
}

}  // namespace

float relative_ior(const Object& bsdf) {
  return static_cast<float>(ior_of(bsdf, "int_ior", dielectrics().at("bk7")) /
                            ior_of(bsdf, "ext_ior", dielectrics().at("air")));
}

Color conductor_reflectance(Context& context, const Object& bsdf) {
  const bool given = bsdf.find("eta") || bsdf.child_named("eta") || bsdf.find("k");
  if (!given) return named_metal(context, bsdf);
  const Color eta =
      read_plain_color(context, bsdf, "eta", Color(0.0f), Quantity::index_of_refraction);
  const Color k = read_plain_color(context, bsdf, "k", Color(1.0f), Quantity::index_of_refraction);
  const auto outside = static_cast<float>(ior_of(bsdf, "ext_eta", 1.0));
  const Color minus = eta - outside, plus = eta + outside;
  const Color denominator = plus * plus + k * k;  // above 0, as `outside` is
  return (minus * minus + k * k) / denominator;
}

}  // namespace pt::mitsuba
