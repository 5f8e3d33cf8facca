#include <fmt/format.h>

#include <algorithm>
#include <atomic>
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

/// The cells in whose values a voxel along an axis has a part: [first, last].
struct CellRange {
  std::uint32_t first, last;

  bool operator==(const CellRange&) const = default;
};

/// The majorants of a sparse grid: those that it would have if it were dense.
class SparseMajorants {
 public:
  SparseMajorants(const VolumeGrid& grid, const SparseHead& head, float* majorants)
      : grid_(grid), head_(head), majorants_(majorants) {
    for (int axis = 0; axis < 3; ++axis) {
      cells_of_[axis].assign(grid.size[axis], {grid.cells[axis], 0});
      for (std::uint32_t cell = 0; cell < grid.cells[axis]; ++cell) {
        const VoxelRange voxels(cell, grid.cells[axis], grid.size[axis], grid.interpolates != 0);
        for (std::uint32_t v = voxels.begin; v < voxels.end; ++v) {
          CellRange& cells = cells_of_[axis][v];
          cells = {std::min(cells.first, cell), cell};
        }
      }
    }
  }

  /// Thread-safe.
  void add(const SparseBrick& brick) const {
    for_runs(brick, 0, [&](int x0, int x1, const CellRange& x) {
      for_runs(brick, 1, [&](int y0, int y1, const CellRange& y) {
        for_runs(brick, 2, [&](int z0, int z1, const CellRange& z) {
          float largest = brick.value;
          for (int i = x0; brick.values != nullptr && i < x1; ++i) {
            for (int j = y0; j < y1; ++j) {
              const float* const row = brick.values + (i * 8 + j) * 8;
              largest = std::max(largest, *std::max_element(row + z0, row + z1));
            }
          }
          raise(x, y, z, largest);
        });
      });
    });
  }

 private:
  /// Calls function(begin, end, cells) for the brick's voxels along an axis that have a part in the
  /// same cells.
  template <class Function>
  void for_runs(const SparseBrick& brick, int axis, Function&& function) const {
    const int low = brick.low[axis] - head_.low[axis];
    const int last = std::min(brick.side, static_cast<int>(grid_.size[axis]) - low);
    const auto cells = [&](int i) { return cells_of_[axis][static_cast<std::size_t>(low + i)]; };
    for (int begin = std::max(0, -low); begin < last;) {
      int end = begin + 1;
      while (end < last && cells(end) == cells(begin)) ++end;
      function(begin, end, cells(begin));
      begin = end;
    }
  }

  void raise(const CellRange& x, const CellRange& y, const CellRange& z, float value) const {
    for (std::uint32_t k = z.first; k <= z.last; ++k) {
      for (std::uint32_t j = y.first; j <= y.last; ++j) {
        for (std::uint32_t i = x.first; i <= x.last; ++i) {
          float& majorant = majorants_[i + grid_.cells[0] * (j + std::size_t{grid_.cells[1]} * k)];
          raise_to(std::atomic_ref(majorant), value);
        }
      }
    }
  }

  const VolumeGrid& grid_;
  const SparseHead& head_;
  float* majorants_;
  std::vector<CellRange> cells_of_[3];  ///< by voxel
};

void bound_sparse(SceneData& scene, VolumeGrid& grid) {
  grid.ends = 1;
  scene.majorants.resize(scene.majorants.size() +
                         std::size_t{grid.cells[0]} * grid.cells[1] * grid.cells[2]);
  const SparseBlock* const root = &scene.grid_nodes[grid.root];
  const SparseMajorants majorants(grid, *reinterpret_cast<const SparseHead*>(root - 1),
                                  &scene.majorants[grid.first_cell]);
  for_each_brick(root, [&](const SparseBrick& brick) { majorants.add(brick); });
}

void bound(SceneData& scene, VolumeGrid& grid) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint32_t wanted = (grid.size[axis] + cell_voxels - 1) / cell_voxels;
    grid.cells[axis] = std::min(wanted, cells_max);
  }
  grid.first_cell = static_cast<std::uint32_t>(scene.majorants.size());
  if (grid.root != 0) return bound_sparse(scene, grid);
  grid.ends = has_empty_rim(grid.size, grid.channels, &scene.grid_values[grid.first]) ? 1 : 0;
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

/// Whether both are one grid in several places.
bool share_voxels(const VolumeGrid& a, const VolumeGrid& b) {
  return a.first == b.first && a.root == b.root && a.channels == b.channels &&
         a.interpolates == b.interpolates && std::ranges::equal(a.size, b.size);
}

/// Writes into empty cells how far the next one is that is not: -d, see VolumeGrids. One more than
/// the nearest of a cell's neighbours: two sweeps find d (Rosenfeld and Pfaltz 1968, 'Distance
/// functions on digital pictures').
void measure_empty_space(const VolumeGrid& grid, float* majorants) {
  constexpr float without_end = 1 << 20;
  const int nx = static_cast<int>(grid.cells[0]), ny = static_cast<int>(grid.cells[1]),
            nz = static_cast<int>(grid.cells[2]), count = nx * ny * nz;
  const auto distance = [](float majorant) { return majorant > 0 ? 0.0f : -majorant; };
  std::replace(majorants, majorants + count, 0.0f, -without_end);
  for (const int way : {1, -1}) {
    for (int n = 0; n < count; ++n) {
      const int cell = way > 0 ? n : count - 1 - n;
      if (majorants[cell] > 0) continue;
      const int x = cell % nx, y = cell / nx % ny, z = cell / nx / ny;
      for (int neighbor = 0; neighbor < 13; ++neighbor) {  // those before it on the way
        const int i = x + way * (neighbor % 3 - 1), j = y + way * (neighbor / 3 % 3 - 1),
                  k = z + way * (neighbor / 9 - 1);
        if (i < 0 || j < 0 || k < 0 || i >= nx || j >= ny || k >= nz) continue;
        const float farther = distance(majorants[i + nx * (j + ny * k)]) + 1;
        majorants[cell] = std::max(majorants[cell], -farther);
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
    if (grid.cells[0] > 0) continue;  // several media may have it
    const auto same = std::ranges::find_if(scene.grids, [&](const VolumeGrid& other) {
      return other.cells[0] > 0 && share_voxels(other, grid);
    });
    if (same != scene.grids.end()) {
      std::ranges::copy(same->cells, grid.cells);
      grid.first_cell = same->first_cell, grid.ends = same->ends;
      continue;
    }
    bound(scene, grid);
    if (scene.grid_nodes.empty()) continue;
    measure_empty_space(grid, &scene.majorants[grid.first_cell]);
  }
}

}  // namespace pt
