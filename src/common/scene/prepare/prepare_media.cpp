#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "common/error/error.h"
#include "common/scene/data/volume_data.h"
#include "common/scene/prepare/prepare_steps.h"

namespace pt {
namespace {

constexpr std::uint32_t cell_voxels = 8, cells_max = 64;

/// The voxels along an axis that have a part in the values of a cell.
struct VoxelRange {
  std::uint32_t begin, end;

  VoxelRange(std::uint32_t cell, std::uint32_t cells, std::uint32_t size, bool interpolates) {
    const double per_cell = static_cast<double>(size) / cells;
    const auto clamped = [&](double voxel) {
      return static_cast<std::uint32_t>(std::clamp(voxel, 0.0, static_cast<double>(size)));
    };
    // One more than needed on each side: kernels round where a point lies.
    const double more = interpolates ? 1.5 : 1.0;
    begin = clamped(std::floor(cell * per_cell - more));
    end = clamped(std::ceil((cell + 1) * per_cell + more));
  }
};

void bound(SceneData& scene, VolumeGrid& grid) {
  grid.ends = has_empty_rim(grid.size, grid.channels, &scene.grid_values[grid.first]) ? 1 : 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint32_t wanted = (grid.size[axis] + cell_voxels - 1) / cell_voxels;
    grid.cells[axis] = std::min(wanted, cells_max);
  }
  grid.first_cell = static_cast<std::uint32_t>(scene.majorants.size());
  const auto range = [&](int axis, std::uint32_t cell) {
    return VoxelRange(cell, grid.cells[axis], grid.size[axis], grid.interpolates != 0);
  };
  for (std::uint32_t k = 0; k < grid.cells[2]; ++k) {
    for (std::uint32_t j = 0; j < grid.cells[1]; ++j) {
      for (std::uint32_t i = 0; i < grid.cells[0]; ++i) {
        const VoxelRange x = range(0, i), y = range(1, j), z = range(2, k);
        float largest = 0;
        for (std::uint32_t w = z.begin; w < z.end; ++w) {
          for (std::uint32_t v = y.begin; v < y.end; ++v) {
            const std::size_t row = std::size_t{grid.size[0]} * (v + std::size_t{grid.size[1]} * w);
            const float* const values = &scene.grid_values[grid.first];
            const float* const first = values + (row + x.begin) * grid.channels;
            const float* const last = values + (row + x.end) * grid.channels;
            largest = std::max(largest, *std::max_element(first, last));
          }
        }
        scene.majorants.push_back(largest);
      }
    }
  }
}

/// So that the order of media is that of their priorities.
void order_media(SceneData& scene) {
  std::vector<std::uint16_t> order(scene.media.size());
  std::iota(order.begin(), order.end(), std::uint16_t{0});
  std::ranges::stable_sort(order, {}, [&](std::uint16_t i) { return scene.media[i].priority; });
  std::vector<Medium> media;
  std::vector<std::uint16_t> place_of(order.size());
  for (const std::uint16_t i : order) {
    place_of[i] = static_cast<std::uint16_t>(media.size());
    media.push_back(scene.media[i]);
  }
  scene.media = std::move(media);
  const auto follow = [&](auto& medium) {
    if (medium != no_medium) medium = place_of[medium];
  };
  for (MaterialDescription& m : scene.materials) follow(m.media.outside), follow(m.media.inside);
  follow(scene.camera_medium);
}

}  // namespace

std::uint32_t camera_medium_id(const SceneData& scene) {
  if (!scene.media_overlap || scene.camera_medium == no_medium) return scene.camera_medium;
  return no_medium ^ 1u << scene.camera_medium;
}

void prepare_media(SceneData& scene) {
  scene.media_overlap = std::ranges::any_of(scene.media, &Medium::priority);
  if (scene.media_overlap) {
    if (scene.media.size() > overlapping_media_max) {
      throw Error(fmt::format("scene '{}': {} media, some with a priority; expected at most {}",
                              scene.name, scene.media.size(), overlapping_media_max));
    }
    order_media(scene);
  }
  scene.boundaries.clear(), scene.majorants.clear(), scene.light_points.clear();
  if (!needs_media(scene)) return;
  for (const MaterialDescription& m : scene.materials) scene.boundaries.push_back(m.media);
  for (const DeltaLight& light : scene.delta_lights) {
    if (light.kind != LightKind::directional) scene.light_points.emplace_back(light.position, 0);
  }
  for (VolumeGrid& grid : scene.grids) std::fill(std::begin(grid.cells), std::end(grid.cells), 0u);
  for (const Medium& medium : scene.media) {
    if (medium.is_homogeneous()) continue;
    VolumeGrid& grid = scene.grids[medium.density_grid];
    if (grid.cells[0] == 0) bound(scene, grid);  // several media may have it
  }
}

}  // namespace pt
