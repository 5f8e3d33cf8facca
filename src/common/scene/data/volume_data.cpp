#include "common/scene/data/volume_data.h"

#include <fmt/format.h>

#include <algorithm>
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

VolumeData with_rim_of_zeros(const VolumeData& volume) {
  VolumeData result;
  result.channels = volume.channels, result.interpolates = volume.interpolates;
  Vec3 voxel, size;
  for (int axis = 0; axis < 3; ++axis) {
    result.size[axis] = volume.size[axis] + 2;
    voxel[axis] = 1.0f / static_cast<float>(volume.size[axis]);
    size[axis] = static_cast<float>(result.size[axis]) * voxel[axis];
  }
  result.to_world = volume.to_world * translate(-voxel) * scale(size);
  result.values.assign(
      std::size_t{result.size[0]} * result.size[1] * result.size[2] * volume.channels, 0.0f);
  const std::size_t length = std::size_t{volume.size[0]} * volume.channels;
  auto from = volume.values.begin();
  for (std::size_t k = 1; k <= volume.size[2]; ++k) {
    for (std::size_t j = 1; j <= volume.size[1]; ++j) {
      const std::size_t to = ((k * result.size[1] + j) * result.size[0] + 1) * volume.channels;
      std::copy_n(from, length, result.values.begin() + static_cast<std::ptrdiff_t>(to));
      from += static_cast<std::ptrdiff_t>(length);
    }
  }
  return result;
}

bool has_empty_rim(const std::uint32_t (&size)[3], std::uint32_t channels, const float* values) {
  const auto is_outermost = [&](int axis, std::uint32_t i) {
    return i == 0 || i + 1 == size[axis];
  };
  for (std::uint32_t k = 0; k < size[2]; ++k) {
    for (std::uint32_t j = 0; j < size[1]; ++j) {
      const bool row_is = is_outermost(1, j) || is_outermost(2, k);
      for (std::uint32_t i = 0; i < size[0]; ++i) {
        for (std::uint32_t c = 0; c < channels; ++c) {
          if (*values++ != 0.0f && (row_is || is_outermost(0, i))) return false;
        }
      }
    }
  }
  return true;
}

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
