// Named media to ours: homogeneous ones, and grids of .nvdb files.
#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "common/math/vec.h"
#include "common/scene/load/files/volumes/volume_files.h"
#include "common/scene/load/pbrt/scene_parts.h"

namespace pt::pbrt {
namespace {

/// In 1 / mm; the scattering is the reduced one, (1 - g) sigma_s.
struct MeasuredMedium {
  Color absorption, scattering;
};

/// Jensen, Marschner, Levoy and Hanrahan 2001, 'A practical model for subsurface light transport',
/// figure 5.
const std::pair<std::string_view, MeasuredMedium> measured_media[] = {
    {"Apple", {{0.0030f, 0.0034f, 0.046f}, {2.29f, 2.39f, 1.97f}}},
    {"Chicken1", {{0.015f, 0.077f, 0.19f}, {0.15f, 0.21f, 0.38f}}},
    {"Chicken2", {{0.018f, 0.088f, 0.20f}, {0.19f, 0.25f, 0.32f}}},
    {"Cream", {{0.0002f, 0.0028f, 0.0163f}, {7.38f, 5.47f, 3.15f}}},
    {"Ketchup", {{0.061f, 0.97f, 1.45f}, {0.18f, 0.07f, 0.03f}}},
    {"Marble", {{0.0021f, 0.0041f, 0.0071f}, {2.19f, 2.62f, 3.00f}}},
    {"Potato", {{0.0024f, 0.0090f, 0.12f}, {0.68f, 0.70f, 0.55f}}},
    {"Skimmilk", {{0.0014f, 0.0025f, 0.0142f}, {0.70f, 1.22f, 1.90f}}},
    {"Skin1", {{0.032f, 0.17f, 0.48f}, {0.74f, 0.88f, 1.01f}}},
    {"Skin2", {{0.013f, 0.070f, 0.145f}, {1.09f, 1.59f, 1.79f}}},
    {"Spectralon", {{0.0f, 0.0f, 0.0f}, {11.6f, 20.4f, 14.9f}}},
    {"Wholemilk", {{0.0011f, 0.0024f, 0.014f}, {2.55f, 3.21f, 3.77f}}},
};

std::optional<MeasuredMedium> measured_medium(std::string_view name) {
  for (const auto& [known, medium] : measured_media) {
    if (known == name) return medium;
  }
  return std::nullopt;
}

/// All of them, for messages.
std::string measured_media_names() {
  std::string names;
  for (const auto& entry : measured_media) {
    names += (names.empty() ? "" : ", ") + std::string(entry.first);
  }
  return names;
}

// Media that are the same everywhere, and what all kinds have.

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
  fail(parameters.find(name)->place, "'float {}' of {}; expected a finite number, at least 0", name,
       factor);
}

void read_phase(const Parameters& parameters, Medium& medium) {
  const float g = parameters.number("g", 0.0f);
  if (!(std::abs(g) < 1.0f)) {
    fail(parameters.find("g")->place, "'float g' of {}; expected more than -1 and less than 1", g);
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
      context.reporter.warn_once(
          "preset " + name, preset->place,
          "preset '{}' is not supported: sigma_a and sigma_s are used; expected {}", name,
          measured_media_names());
    }
  }
  medium.emission = context.imaging_ratio * read_factor(parameters, "Lescale", 1.0f) *
                    read_color(context, parameters, "Le", Color(0.0f), Quantity::illuminant);
  if (!is_black(medium.emission)) context.lit = true;
  return medium;
}

namespace {

// Media whose density and temperature are grids of a .nvdb file.

/// Light of a blackbody in each voxel of a grid that need not be where the density's is. Beyond it
/// the temperature is that of its rim, 0.
void read_emission_of_gas(Context& context, const Entity& entity, const Parameter& filename,
                          VolumeData temperature, Medium& medium) {
  const float light_scale = read_factor(entity.parameters, "Lescale", 1.0f);
  VolumeData volume = std::move(temperature);
  std::vector<float> numbered;
  if (volume.is_sparse() && !number_voxels(volume, numbered)) volume = dense_copy(volume);
  const std::vector<Color> light = read_gas_light(entity.parameters, filename.place,
                                                  volume.is_sparse() ? numbered : volume.values);
  if (light_scale == 0.0f) return;
  volume.channels = 3;
  (volume.is_sparse() ? volume.colors : volume.values) = channels_of(light, 3);
  volume.to_world = entity.to_world * volume.to_world;
  medium.emission = Color(context.imaging_ratio * light_scale);
  medium.emission_grid = add_grid(context.scene, std::move(volume));
  context.lit = true;
}

/// The grids of a medium, in its space.
struct GasGrids {
  VolumeData density;
  std::optional<VolumeData> temperature;
};

GasGrids read_gas_grids(Context& context, const Parameter& filename) {
  const auto path = context.resolve(filename.place, filename.strings.at(0));
  try {
    GasGrids grids{read_nanovdb(path, {}, context.volume_storage), {}};
    if (has_nanovdb_grid(path, "temperature")) {
      grids.temperature = read_nanovdb(path, "temperature", context.volume_storage);
    }
    return grids;
  } catch (const Error& error) {
    fail(filename.place, error.what());
  }
}

}  // namespace

Medium read_nanovdb_grids(Context& context, const Entity& entity) {
  const Parameters& parameters = entity.parameters;
  const Parameter* filename = parameters.find("filename", {"string"});
  if (!filename) {
    fail(parameters.place(), "{}: no 'string filename'", parameters.what());
  }
  Medium medium = read_coefficients(context, parameters, read_factor(parameters, "scale", 1.0f));
  GasGrids grids = read_gas_grids(context, *filename);
  grids.density.to_world = entity.to_world * grids.density.to_world;
  medium.density_grid = add_grid(context.scene, std::move(grids.density));
  if (grids.temperature) {
    read_emission_of_gas(context, entity, *filename, std::move(*grids.temperature), medium);
  } else {
    parameters.ignore({"Lescale", "temperatureoffset", "temperaturecutoff", "temperaturescale"});
  }
  return medium;
}

namespace {

constexpr std::size_t media_max = no_medium - 1u;

using MediumReader = Medium (*)(Context&, const Entity&);

const std::map<std::string_view, MediumReader>& medium_readers() {
  static const std::map<std::string_view, MediumReader> table = {
      {"homogeneous", read_homogeneous}, {"uniformgrid", read_uniform_grid},
      {"rgbgrid", read_rgb_grid},        {"cloud", read_cloud},
      {"nanovdb", read_nanovdb_grids},   {"heterogeneous", read_uniform_grid},
  };
  return table;
}

std::uint16_t add_medium(Context& context, const std::string& name, const Entity& entity) {
  const Parameters& parameters = entity.parameters;
  if (!parameters.find("type", {"string"})) {
    fail(parameters.place(), "medium '{}' has no 'string type'", name);
  }
  const std::string type = parameters.text("type", "");
  const auto reader = medium_readers().find(type);
  if (reader == medium_readers().end()) {
    context.reporter.warn_once("medium " + type, parameters.place(),
                               "medium '{}' is not supported: there is none instead; expected "
                               "homogeneous, uniformgrid, rgbgrid, cloud or nanovdb",
                               type);
    return no_medium;
  }
  Medium medium = reader->second(context, entity);
  medium.priority = parameters.integer("priority", 0);
  parameters.report_unused(context.reporter);
  std::vector<Medium>& media = context.scene.media;
  if (media.size() == media_max) {
    fail(parameters.place(), "a scene of more than {} media", media_max);
  }
  media.push_back(medium);
  return static_cast<std::uint16_t>(media.size() - 1);
}

std::uint16_t read_medium(Context& context, const std::string& name, const FileLocation& place) {
  const auto found = context.description.media.find(name);
  if (found == context.description.media.end()) {
    fail(place, "there is no medium '{}'; expected one that MakeNamedMedium defines", name);
  }
  return add_medium(context, name, *found->second);
}

}  // namespace

std::uint16_t medium_named(Context& context, const std::string& name, const FileLocation& place) {
  if (name.empty()) return no_medium;
  const auto known = context.media.find(name);
  if (known != context.media.end()) return known->second;
  std::uint16_t& number = context.media[name] = no_medium;
  context.reporter.attempt(fmt::format("medium '{}'", name), "is left out",
                           [&] { number = read_medium(context, name, place); });
  return number;
}

MediumBoundary media_of(Context& context, const ShapeEntity& shape) {
  const FileLocation& place = shape.shape.parameters.place();
  MediumBoundary boundary;
  boundary.inside = medium_named(context, shape.media.inside, place);
  boundary.outside = medium_named(context, shape.media.outside, place);
  return boundary;
}

}  // namespace pt::pbrt
