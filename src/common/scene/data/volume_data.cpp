#include "common/scene/data/volume_data.h"

#include <fmt/format.h>

#include <cmath>

#include "common/error/error.h"

namespace pt {
namespace {

void check(const SceneData& scene, const VolumeData& v) {
  const auto fail = [&](const std::string& problem) {
    throw Error(fmt::format("scene '{}': a grid of {} x {} x {} voxels: {}", scene.name, v.size[0],
                            v.size[1], v.size[2], problem));
  };
  const std::uint64_t voxels = std::uint64_t{v.size[0]} * v.size[1] * v.size[2];
  if (voxels == 0) fail("expected at least one");
  if (v.channels != 1 && v.channels != 3) {
    fail(fmt::format("{} channels; expected 1 or 3", v.channels));
  }
  if (v.values.size() != voxels * v.channels) {
    fail(fmt::format("{} values; expected {}", v.values.size(), voxels * v.channels));
  }
  if (scene.grid_values.size() + v.values.size() > 0xffffffffu) {
    fail("expected at most 4,294,967,295 values in all grids");
  }
  for (const float value : v.values) {
    if (!(value >= 0) || !std::isfinite(value)) {
      fail(fmt::format("a value of {}; expected finite ones, at least 0", value));
    }
  }
  const float determinant = v.to_world.determinant();
  if (!std::isfinite(determinant) || determinant == 0) fail("expected a map that has an inverse");
}

}  // namespace

std::uint32_t add_grid(SceneData& scene, const VolumeData& volume) {
  check(scene, volume);
  VolumeGrid grid;
  grid.to_unit = inverse(volume.to_world);
  std::copy(std::begin(volume.size), std::end(volume.size), std::begin(grid.size));
  grid.first = static_cast<std::uint32_t>(scene.grid_values.size());
  grid.channels = volume.channels;
  grid.interpolates = volume.interpolates ? 1 : 0;
  scene.grid_values.insert(scene.grid_values.end(), volume.values.begin(), volume.values.end());
  scene.grids.push_back(grid);
  return static_cast<std::uint32_t>(scene.grids.size() - 1);
}

}  // namespace pt
