// Media of regular samples.
#include <algorithm>
#include <cmath>

#include "common/scene/load/pbrt/scene_parts.h"
#include "common/scene/load/pbrt/syntax/description.h"

namespace pt::pbrt {
namespace {

Vec3 size_of(const SampleBox& box) { return Vec3(box.size[0], box.size[1], box.size[2]); }

/// From the cube [0, 1]^3 to the world.
Affine cube_to_world(const SampleBox& box) {
  return box.to_world * translate(box.low) * scale(box.high - box.low);
}

std::uint32_t read_side_of_grid(const Parameters& parameters, const char* name) {
  constexpr int most = 1 << 16;
  const int side = parameters.integer(name, 1);
  if (side >= 1 && side <= most) return static_cast<std::uint32_t>(side);
  fail(parameters.find(name)->place, "'integer {}' of {}; expected 1 to {} samples", name, side,
       most);
}

}  // namespace

Vec3 SampleBox::center(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
  return low + (high - low) * (Vec3(i, j, k) + Vec3(0.5f)) / size_of(*this);
}

SampleBox read_box(const Entity& entity) {
  const Parameters& parameters = entity.parameters;
  const Vec3 p0 = parameters.point("p0", Vec3(0.0f)), p1 = parameters.point("p1", Vec3(1.0f));
  SampleBox box;
  box.low = glm::min(p0, p1), box.high = glm::max(p0, p1);
  box.to_world = entity.to_world;
  if (!is_invertible(cube_to_world(box))) {
    fail(parameters.place(),
         "{}: a grid without volume; expected p0 and p1 that differ in all coordinates, and a "
         "transformation that has an inverse",
         parameters.what());
  }
  return box;
}

SampleBox read_sample_box(const Entity& entity) {
  SampleBox box = read_box(entity);
  const char* const names[] = {"nx", "ny", "nz"};
  for (int axis = 0; axis < 3; ++axis) {
    box.size[axis] = read_side_of_grid(entity.parameters, names[axis]);
  }
  return box;
}

std::vector<float> channels_of(const std::vector<Color>& colors, std::uint32_t channels) {
  std::vector<float> values;
  values.reserve(colors.size() * channels);
  for (const Color& c : colors) {
    values.push_back(c.x);
    if (channels == 3) values.insert(values.end(), {c.y, c.z});
  }
  return values;
}

VolumeData plain_volume(const SampleBox& box, std::uint32_t channels, std::vector<float> values) {
  VolumeData volume;
  std::copy(std::begin(box.size), std::end(box.size), std::begin(volume.size));
  volume.channels = channels;
  volume.values = std::move(values);
  volume.to_world = cube_to_world(box);
  return volume;
}

VolumeData faded_volume(const SampleBox& box, std::uint32_t channels,
                        const std::vector<float>& values) {
  return with_rim_of_zeros(plain_volume(box, channels, values));
}

namespace {

// Media whose density varies and whose colours do not.

/// One number for each voxel; empty where the parameter is absent.
std::vector<float> read_samples_of(const Parameters& parameters, const char* name,
                                   const SampleBox& box) {
  const std::vector<float> values = parameters.numbers(name);
  const Parameter* parameter = parameters.find(name);
  if (!parameter) return values;
  if (values.size() != box.voxels()) {
    fail(parameter->place, "'float {}' has {} values; expected nx * ny * nz = {}", name,
         values.size(), box.voxels());
  }
  for (const float value : values) {
    if (value >= 0.0f && std::isfinite(value)) continue;
    fail(parameter->place, "'float {}': {}; expected finite numbers, at least 0", name, value);
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
    fail(parameters.place(), "{}: no 'float density'; expected nx * ny * nz = {} values",
         parameters.what(), box.voxels());
  }
  Medium medium = read_coefficients(context, parameters, read_factor(parameters, "scale", 1.0f));
  medium.density_grid = add_grid(context.scene, faded_volume(box, 1, density));
  read_emission_of_grid(context, parameters, box, medium);
  return medium;
}

namespace {

// Media whose coefficients vary in each channel.

using Colors = std::vector<Color>;

/// One colour for each voxel; empty where the parameter is absent.
Colors read_colors(const Parameters& parameters, const char* name, const SampleBox& box) {
  Colors colors;
  const Parameter* parameter = parameters.find(name, {"rgb", "color"});
  if (!parameter) return colors;
  const std::vector<double>& numbers = parameter->numbers;
  if (numbers.size() != 3 * box.voxels()) {
    fail(parameter->place, "'rgb {}' has {} numbers; expected 3 * nx * ny * nz = {}", name,
         numbers.size(), 3 * box.voxels());
  }
  colors.reserve(box.voxels());
  for (std::size_t i = 0; i < numbers.size(); i += 3) {
    const Color color(numbers[i], numbers[i + 1], numbers[i + 2]);
    for (int c = 0; c < 3; ++c) {
      if (color[c] >= 0.0f && std::isfinite(color[c])) continue;
      fail(parameter->place, "'rgb {}': {}; expected finite numbers, at least 0", name, color[c]);
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

/// If one of the two coefficients is absent, it is 1 everywhere, as in pbrt.
Medium read_rgb_grid(Context& context, const Entity& entity) {
  const Parameters& parameters = entity.parameters;
  const SampleBox box = read_sample_box(entity);
  Colors absorption = read_colors(parameters, "sigma_a", box);
  Colors scattering = read_colors(parameters, "sigma_s", box);
  const Colors light = read_colors(parameters, "Le", box);
  if (absorption.empty() && scattering.empty()) {
    fail(parameters.place(), "{}: expected 'rgb sigma_a' or 'rgb sigma_s'", parameters.what());
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
