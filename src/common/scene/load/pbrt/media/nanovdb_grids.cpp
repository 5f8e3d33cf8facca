// Media whose density and temperature are grids of a .nvdb file.
#include <fmt/format.h>

#include <optional>

#include "common/scene/load/files/volumes/nanovdb_file.h"
#include "common/scene/load/pbrt/colors/glowing_gas.h"
#include "common/scene/load/pbrt/media/medium_kinds.h"
#include "common/scene/load/pbrt/media/sample_box.h"

namespace pt::pbrt {
namespace {

/// Light of a blackbody in each voxel of a grid that need not be where the density's is. Beyond it
/// the temperature is that of its rim, 0.
void read_emission_of_gas(Context& context, const Entity& entity, const Parameter& filename,
                          VolumeData temperature, Medium& medium) {
  const float light_scale = read_factor(entity.parameters, "Lescale", 1.0f);
  const std::vector<Color> light =
      read_gas_light(entity.parameters, filename.place, temperature.values);
  if (light_scale == 0.0f) return;
  VolumeData volume = std::move(temperature);
  volume.channels = 3;
  volume.values = channels_of(light, 3);
  volume.to_world = entity.to_world * volume.to_world;
  medium.emission = Color(context.imaging_ratio * light_scale);
  medium.emission_grid = add_grid(context.scene, volume);
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
    GasGrids grids{read_nanovdb(path), {}};
    if (has_nanovdb_grid(path, "temperature")) {
      grids.temperature = read_nanovdb(path, "temperature");
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
    fail(parameters.place(), fmt::format("{}: no 'string filename'", parameters.what()));
  }
  Medium medium = read_coefficients(context, parameters, read_factor(parameters, "scale", 1.0f));
  GasGrids grids = read_gas_grids(context, *filename);
  grids.density.to_world = entity.to_world * grids.density.to_world;
  medium.density_grid = add_grid(context.scene, grids.density);
  if (grids.temperature) {
    read_emission_of_gas(context, entity, *filename, std::move(*grids.temperature), medium);
  } else {
    parameters.ignore({"Lescale", "temperatureoffset", "temperaturecutoff", "temperaturescale"});
  }
  return medium;
}

}  // namespace pt::pbrt
