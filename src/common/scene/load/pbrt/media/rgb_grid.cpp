// Media whose coefficients vary in each channel.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/scene/load/pbrt/media/medium_kinds.h"
#include "common/scene/load/pbrt/media/sample_box.h"

namespace pt::pbrt {
namespace {

using Colors = std::vector<Color>;

/// One colour for each voxel; empty where the parameter is absent.
Colors read_colors(const Parameters& parameters, const char* name, const SampleBox& box) {
  Colors colors;
  const Parameter* parameter = parameters.find(name, {"rgb", "color"});
  if (!parameter) return colors;
  const std::vector<double>& numbers = parameter->numbers;
  if (numbers.size() != 3 * box.voxels()) {
    fail(parameter->place, fmt::format("'rgb {}' has {} numbers; expected 3 * nx * ny * nz = {}",
                                       name, numbers.size(), 3 * box.voxels()));
  }
  colors.reserve(box.voxels());
  for (std::size_t i = 0; i < numbers.size(); i += 3) {
    const Color color(numbers[i], numbers[i + 1], numbers[i + 2]);
    for (int c = 0; c < 3; ++c) {
      if (color[c] >= 0.0f && std::isfinite(color[c])) continue;
      fail(parameter->place,
           fmt::format("'rgb {}': {}; expected finite numbers, at least 0", name, color[c]));
    }
    colors.push_back(to_srgb(color, parameter->space));
  }
  return colors;
}

bool are_grey(const Colors& colors) {
  return std::ranges::all_of(colors, [](const Color& c) { return c.x == c.y && c.y == c.z; });
}

/// By voxel. A channel of nothing gets the albedo of what is around it: where it is looked up,
/// between voxels, only that scatters.
Colors albedos(const SampleBox& box, const Colors& absorption, const Colors& scattering) {
  Colors result;
  result.reserve(absorption.size());
  const auto index = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    return (std::size_t{k} * box.size[1] + j) * box.size[0] + i;
  };
  const auto around = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    Color absorbed(0.0f), scattered(0.0f);
    const auto begin = [](std::uint32_t v) { return v == 0 ? 0u : v - 1; };
    for (std::uint32_t k = begin(z); k < std::min(z + 2, box.size[2]); ++k) {
      for (std::uint32_t j = begin(y); j < std::min(y + 2, box.size[1]); ++j) {
        for (std::uint32_t i = begin(x); i < std::min(x + 2, box.size[0]); ++i) {
          absorbed += absorption[index(i, j, k)], scattered += scattering[index(i, j, k)];
        }
      }
    }
    return albedo_of(absorbed, scattered);
  };
  for (std::uint32_t k = 0; k < box.size[2]; ++k) {
    for (std::uint32_t j = 0; j < box.size[1]; ++j) {
      for (std::uint32_t i = 0; i < box.size[0]; ++i) {
        const Color &a = absorption[index(i, j, k)], &s = scattering[index(i, j, k)];
        Color albedo = albedo_of(a, s);
        const bool has_nothing = a.x + s.x == 0 || a.y + s.y == 0 || a.z + s.z == 0;
        if (has_nothing) {
          const Color other = around(i, j, k);
          for (int c = 0; c < 3; ++c) {
            if (a[c] + s[c] == 0) albedo[c] = other[c];
          }
        }
        result.push_back(albedo);
      }
    }
  }
  return result;
}

void set_albedo(SceneData& scene, const SampleBox& box, const Colors& albedo, Medium& medium) {
  const bool constant =
      std::ranges::all_of(albedo, [&](const Color& c) { return c == albedo.front(); });
  medium.albedo = constant ? albedo.front() : Color(1.0f);
  if (constant) return;
  const std::uint32_t channels = are_grey(albedo) ? 1 : 3;
  medium.albedo_grid = add_grid(scene, plain_volume(box, channels, channels_of(albedo, channels)));
}

}  // namespace

/// Of the two coefficients, one that is absent is 1 everywhere in pbrt.
Medium read_rgb_grid(Context& context, const Entity& entity) {
  const Parameters& parameters = entity.parameters;
  const SampleBox box = read_sample_box(entity);
  Colors absorption = read_colors(parameters, "sigma_a", box);
  Colors scattering = read_colors(parameters, "sigma_s", box);
  const Colors light = read_colors(parameters, "Le", box);
  if (absorption.empty() && scattering.empty()) {
    fail(parameters.place(),
         fmt::format("{}: expected 'rgb sigma_a' or 'rgb sigma_s'", parameters.what()));
  }
  if (!light.empty() && absorption.empty()) {
    fail(parameters.find("Le")->place, "'rgb Le' without 'rgb sigma_a'");
  }
  absorption.resize(box.voxels(), Color(1.0f)), scattering.resize(box.voxels(), Color(1.0f));
  Medium medium;
  read_phase(parameters, medium);
  medium.extinction = Color(read_factor(parameters, "scale", 1.0f));
  set_albedo(context.scene, box, albedos(box, absorption, scattering), medium);
  Colors extinction = std::move(absorption);
  for (std::size_t i = 0; i < extinction.size(); ++i) extinction[i] += scattering[i];
  const std::uint32_t channels = are_grey(extinction) ? 1 : 3;
  medium.density_grid =
      add_grid(context.scene, faded_volume(box, channels, channels_of(extinction, channels)));
  const float light_scale = read_factor(parameters, "Lescale", 1.0f);
  if (light.empty() || light_scale == 0.0f) return medium;
  medium.emission = Color(context.imaging_ratio * light_scale);
  medium.emission_grid = add_grid(context.scene, faded_volume(box, 3, channels_of(light, 3)));
  context.lit = true;
  return medium;
}

}  // namespace pt::pbrt
