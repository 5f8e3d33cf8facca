// Media whose density varies and whose colours do not.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/scene/load/pbrt/colors/glowing_gas.h"
#include "common/scene/load/pbrt/media/medium_kinds.h"
#include "common/scene/load/pbrt/media/sample_box.h"

namespace pt::pbrt {
namespace {

/// One number for each voxel; empty where the parameter is absent.
std::vector<float> read_samples_of(const Parameters& parameters, const char* name,
                                   const SampleBox& box) {
  const std::vector<float> values = parameters.numbers(name);
  const Parameter* parameter = parameters.find(name);
  if (!parameter) return values;
  if (values.size() != box.voxels()) {
    fail(parameter->place, fmt::format("'float {}' has {} values; expected nx * ny * nz = {}", name,
                                       values.size(), box.voxels()));
  }
  for (const float value : values) {
    if (value >= 0.0f && std::isfinite(value)) continue;
    fail(parameter->place,
         fmt::format("'float {}': {}; expected finite numbers, at least 0", name, value));
  }
  return values;
}

/// pbrt takes a scale that is not given for a grid of a single 1: it fades from the middle of the
/// box, to a half at the middle of its faces.
float fading_scale(const SampleBox& box, std::uint32_t i, std::uint32_t j, std::uint32_t k) {
  const auto tent = [](std::uint32_t index, std::uint32_t size) {
    return 1.0f - std::abs((static_cast<float>(index) + 0.5f) / static_cast<float>(size) - 0.5f);
  };
  return tent(i, box.size[0]) * tent(j, box.size[1]) * tent(k, box.size[2]);
}

/// Light of a blackbody in each voxel. Between samples pbrt interpolates temperatures, and we their
/// light.
void read_temperature(Context& context, const Parameters& parameters, const SampleBox& box,
                      const std::vector<float>& scales, Medium& medium) {
  std::vector<Color> light = read_gas_light(parameters, parameters.find("temperature")->place,
                                            read_samples_of(parameters, "temperature", box));
  std::size_t voxel = 0;
  for (std::uint32_t k = 0; k < box.size[2]; ++k) {
    for (std::uint32_t j = 0; j < box.size[1]; ++j) {
      for (std::uint32_t i = 0; i < box.size[0]; ++i, ++voxel) {
        light[voxel] *= scales.empty() ? fading_scale(box, i, j, k) : scales[voxel];
      }
    }
  }
  medium.emission = Color(context.imaging_ratio);
  medium.emission_grid = add_grid(context.scene, faded_volume(box, 3, channels_of(light, 3)));
  context.lit = true;
}

void read_emission_of_grid(Context& context, const Parameters& parameters, const SampleBox& box,
                           Medium& medium) {
  const std::vector<float> scales = read_samples_of(parameters, "Lescale", box);
  const Parameter* const le = parameters.find("Le");
  if (const Parameter* temperature = parameters.find("temperature")) {
    if (le) fail(temperature->place, "a grid of both 'Le' and 'temperature'");
    return read_temperature(context, parameters, box, scales, medium);
  }
  parameters.ignore({"temperatureoffset", "temperaturecutoff", "temperaturescale"});
  if (!le) return;
  medium.emission = context.imaging_ratio * read_color(context, *le, Quantity::illuminant);
  if (is_black(medium.emission)) return;
  SampleBox whole = box;
  std::fill(std::begin(whole.size), std::end(whole.size), 1u);
  const VolumeData volume =
      scales.empty() ? faded_volume(whole, 1, {1.0f}) : faded_volume(box, 1, scales);
  medium.emission_grid = add_grid(context.scene, volume);
  context.lit = true;
}

}  // namespace

Medium read_uniform_grid(Context& context, const Entity& entity) {
  const Parameters& parameters = entity.parameters;
  const SampleBox box = read_sample_box(entity);
  const std::vector<float> density = read_samples_of(parameters, "density", box);
  if (density.empty()) {
    fail(parameters.place(), fmt::format("{}: no 'float density'; expected nx * ny * nz = {} "
                                         "values",
                                         parameters.what(), box.voxels()));
  }
  Medium medium = read_coefficients(context, parameters, read_factor(parameters, "scale", 1.0f));
  medium.density_grid = add_grid(context.scene, faded_volume(box, 1, density));
  read_emission_of_grid(context, parameters, box, medium);
  return medium;
}

}  // namespace pt::pbrt
