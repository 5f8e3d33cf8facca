#include "common/scene/data/volume_data.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

#include "common/error/error.h"
#include "common/error/host_memory.h"

namespace pt {
namespace {

[[noreturn]] void refuse(const SceneData& scene, const VolumeData& v, const std::string& problem) {
  throw Error(fmt::format("scene '{}': a grid of {} x {} x {} voxels: {}", scene.name, v.size[0],
                          v.size[1], v.size[2], problem));
}

void check(const SceneData& scene, const VolumeData& v) {
  const auto fail = [&](const std::string& problem) { refuse(scene, v, problem); };
  const std::uint64_t voxels = std::uint64_t{v.size[0]} * v.size[1] * v.size[2];
  if (voxels == 0) fail("expected at least one");
  if (v.channels != 1 && v.channels != 3) {
    fail(fmt::format("{} channels; expected 1 or 3", v.channels));
  }
  if (!v.is_sparse() && v.values.size() != voxels * v.channels) {
    fail(fmt::format("{} values; expected {}", v.values.size(), voxels * v.channels));
  }
  for (const float value : v.is_sparse() ? v.colors : v.values) {
    if (!(value >= 0) || !std::isfinite(value)) {
      fail(fmt::format("a value of {}; expected finite ones, at least 0", value));
    }
  }
  if (!is_invertible(v.to_world)) fail("expected a map that has an inverse");
}

void check_room(const SceneData& scene, const VolumeData& v) {
  if (scene.grid_nodes.size() + v.nodes.size() > 0xffffffffu)
    refuse(scene, v, "expected at most 128 GiB of all sparse grids");
  if (scene.grid_values.size() + v.values.size() + v.colors.size() > 0xffffffffu)
    refuse(scene, v, "expected at most 4,294,967,295 values in all grids");
}

template <class T>
bool has_at(const std::vector<T>& all, std::size_t first, const std::vector<T>& part) {
  return first + part.size() <= all.size() &&
         (part.empty() || std::memcmp(&all[first], part.data(), part.size() * sizeof(T)) == 0);
}

/// A grid of the scene that has the same voxels, of a cloud that stands in several places.
const VolumeGrid* find_equal(const SceneData& scene, const VolumeData& v) {
  const auto is_equal = [&](const VolumeGrid& grid) {
    return std::equal(std::begin(v.size), std::end(v.size), std::begin(grid.size)) &&
           grid.channels == v.channels && (grid.interpolates != 0) == v.interpolates &&
           (grid.root != 0) == v.is_sparse() && grid.root >= v.root &&
           has_at(scene.grid_values, grid.first, v.is_sparse() ? v.colors : v.values) &&
           has_at(scene.grid_nodes, grid.root - v.root, v.nodes);
  };
  const auto found = std::ranges::find_if(scene.grids, is_equal);
  return found == scene.grids.end() ? nullptr : &*found;
}

}  // namespace

void widen_by_rim(VolumeData& volume) {
  Vec3 voxel, size;
  for (int axis = 0; axis < 3; ++axis) {
    voxel[axis] = 1.0f / static_cast<float>(volume.size[axis]);
    volume.size[axis] += 2, volume.low[axis] -= 1;
    size[axis] = static_cast<float>(volume.size[axis]) * voxel[axis];
  }
  volume.to_world = volume.to_world * translate(-voxel) * scale(size);
}

VolumeData with_rim_of_zeros(const VolumeData& volume) {
  VolumeData result;
  result.channels = volume.channels, result.interpolates = volume.interpolates;
  std::copy(std::begin(volume.size), std::end(volume.size), std::begin(result.size));
  result.to_world = volume.to_world;
  widen_by_rim(result);
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

std::uint32_t add_grid(SceneData& scene, VolumeData volume) {
  check(scene, volume);
  const auto append = [](auto& to, auto&& from) {
    if (to.empty()) {
      to = std::move(from);
    } else {
      to.insert(to.end(), from.begin(), from.end());
    }
  };
  if (volume.is_sparse()) {
    static_assert(offsetof(SparseHead, low) == 0);
    std::memcpy(&volume.nodes[volume.root - 1], volume.low, sizeof volume.low);
  }
  VolumeGrid grid;
  if (const VolumeGrid* const equal = find_equal(scene, volume)) {
    grid = *equal;
  } else {
    check_room(scene, volume);
    std::copy(std::begin(volume.size), std::end(volume.size), std::begin(grid.size));
    grid.first = static_cast<std::uint32_t>(scene.grid_values.size());
    grid.channels = volume.channels;
    grid.interpolates = volume.interpolates ? 1 : 0;
    if (volume.is_sparse())
      grid.root = static_cast<std::uint32_t>(scene.grid_nodes.size()) + volume.root;
    append(scene.grid_values, std::move(volume.is_sparse() ? volume.colors : volume.values));
    append(scene.grid_nodes, std::move(volume.nodes));
  }
  grid.to_unit = inverse(volume.to_world);
  scene.grids.push_back(grid);
  return static_cast<std::uint32_t>(scene.grids.size() - 1);
}

float largest_value(const VolumeData& volume) {
  if (!volume.is_sparse()) return *std::max_element(volume.values.begin(), volume.values.end());
  float largest = 0.0f;
  for_each_brick(&volume.nodes[volume.root], [&](const SparseBrick& brick) {
    const float value =
        brick.values ? *std::max_element(brick.values, brick.values + 512) : brick.value;
    raise_to(std::atomic_ref(largest), value);
  });
  return largest;
}

VolumeData dense_copy(const VolumeData& volume) {
  constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
  std::uint64_t voxels = 1;
  for (const std::uint32_t side : volume.size) {
    if (side > most / voxels) {
      throw Error(
          fmt::format("{} x {} x {} voxels around its active ones, expected at most {} in "
                      "a dense grid; --volume sparse keeps it as it is",
                      volume.size[0], volume.size[1], volume.size[2], most));
    }
    voxels *= side;
  }
  check_host_memory(voxels * sizeof(float), "the dense grid");
  VolumeData dense;
  std::copy(std::begin(volume.size), std::end(volume.size), std::begin(dense.size));
  dense.interpolates = volume.interpolates, dense.to_world = volume.to_world;
  dense.values.assign(voxels, 0.0f);
  for_each_brick(&volume.nodes[volume.root], [&](const SparseBrick& brick) {
    const glm::ivec3 low = brick.low - glm::ivec3(volume.low[0], volume.low[1], volume.low[2]);
    const auto clamped = [&](int axis, int end) {
      const int side = static_cast<int>(volume.size[axis]);
      return std::clamp(low[axis] + (end == 0 ? 0 : brick.side), 0, side);
    };
    for (int z = clamped(2, 0); z < clamped(2, 1); ++z) {
      for (int y = clamped(1, 0); y < clamped(1, 1); ++y) {
        float* const row = &dense.values[(std::size_t{volume.size[1]} * static_cast<unsigned>(z) +
                                          static_cast<unsigned>(y)) *
                                         volume.size[0]];
        for (int x = clamped(0, 0); x < clamped(0, 1); ++x) {
          row[x] = brick.values ? brick.values[((x - low.x) * 8 + (y - low.y)) * 8 + (z - low.z)]
                                : brick.value;
        }
      }
    }
  });
  return dense;
}

VolumeData stored_as(VolumeStorage storage, VolumeData volume) {
  // A dense grid costs fewer loads. What fits into a GPU's cache, or is hardly larger, is dense.
  constexpr double small_bytes = 64 << 20, tree_share = 0.5;
  const double bytes = 4.0 * volume.size[0] * volume.size[1] * volume.size[2];
  const double tree_bytes = static_cast<double>(volume.nodes.size() * sizeof(SparseBlock));
  const bool is_sparse = storage == VolumeStorage::automatic
                             ? bytes > small_bytes && tree_bytes < tree_share * bytes
                             : storage == VolumeStorage::sparse;
  return is_sparse ? std::move(volume) : dense_copy(volume);
}

}  // namespace pt
