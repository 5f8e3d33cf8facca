// Media that are the same everywhere, and what all kinds have.
#include <fmt/format.h>

#include <cmath>

#include "common/scene/load/pbrt/media/measured_media.h"
#include "common/scene/load/pbrt/media/medium_kinds.h"

namespace pt::pbrt {
namespace {

Medium medium_of(const Color& absorption, const Color& scattering, float scale) {
  Medium medium;
  medium.extinction = scale * (absorption + scattering);
  medium.albedo = albedo_of(absorption, scattering);
  return medium;
}

}  // namespace

Color albedo_of(const Color& absorption, const Color& scattering) {
  Color albedo(0.0f);
  for (int c = 0; c < 3; ++c) {
    const float sum = absorption[c] + scattering[c];
    if (sum > 0.0f) albedo[c] = std::min(scattering[c] / sum, 1.0f);
  }
  return albedo;
}

float read_factor(const Parameters& parameters, std::string_view name, float fallback) {
  const float factor = parameters.number(name, fallback);
  if (factor >= 0.0f && std::isfinite(factor)) return factor;
  fail(parameters.find(name)->place,
       fmt::format("'float {}' of {}; expected a finite number, at least 0", name, factor));
}

void read_phase(const Parameters& parameters, Medium& medium) {
  const float g = parameters.number("g", 0.0f);
  if (!(std::abs(g) < 1.0f)) {
    fail(parameters.find("g")->place,
         fmt::format("'float g' of {}; expected more than -1 and less than 1", g));
  }
  medium.phase = g == 0.0f ? phase_kind_of<Isotropic> : phase_kind_of<HenyeyGreenstein>;
  medium.phase_parameter = g;
}

Medium read_coefficients(Context& context, const Parameters& parameters, float scale) {
  const bool is_earlier = context.description.is_earlier;
  const auto read = [&](std::string_view name, const Color& earlier) {
    return read_color(context, parameters, name, is_earlier ? earlier : Color(1.0f),
                      Quantity::unbounded);
  };
  Medium medium = medium_of(read("sigma_a", {0.0011f, 0.0024f, 0.014f}),
                            read("sigma_s", {2.55f, 3.21f, 3.77f}), scale);
  read_phase(parameters, medium);
  return medium;
}

/// A preset is used instead of sigma_a and sigma_s, as in pbrt.
Medium read_homogeneous(Context& context, const Entity& entity) {
  const Parameters& parameters = entity.parameters;
  const float scale = read_factor(parameters, "scale", 1.0f);
  Medium medium = read_coefficients(context, parameters, scale);
  if (const Parameter* preset = parameters.find("preset", {"string"})) {
    const std::string name = parameters.text("preset", "");
    if (const auto measured = measured_medium(name)) {
      const Medium of_name = medium_of(measured->absorption, measured->scattering, scale);
      medium.extinction = of_name.extinction, medium.albedo = of_name.albedo;
    } else if (!name.empty()) {
      context.reporter.warn_once("preset " + name, preset->place,
                                 fmt::format("preset '{}' is not supported: sigma_a and sigma_s "
                                             "are used; expected {}",
                                             name, measured_media_names()));
    }
  }
  medium.emission = context.imaging_ratio * read_factor(parameters, "Lescale", 1.0f) *
                    read_color(context, parameters, "Le", Color(0.0f), Quantity::illuminant);
  if (!is_black(medium.emission)) context.lit = true;
  return medium;
}

}  // namespace pt::pbrt
