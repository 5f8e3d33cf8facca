// NanoVDB's own readers trust a file. Here its structures are only laid over bytes once these are
// known to hold them.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error/error.h"
#include "common/medium/sparse_tree_nanovdb.h"
#include "common/scene/load/files/volumes/nanovdb.h"
#include "common/scene/load/files/volumes/volume_files.h"
#include "common/scene/load/files/whole_file.h"

namespace pt {

using namespace nanovdb_files;

namespace {

template <class Build>
inline constexpr std::uint32_t log2_bits_of = 0;
template <>
inline constexpr std::uint32_t log2_bits_of<float> = log2_float_bits;
template <>
inline constexpr std::uint32_t log2_bits_of<nanovdb::Fp4> = 2;
template <>
inline constexpr std::uint32_t log2_bits_of<nanovdb::Fp8> = 3;
template <>
inline constexpr std::uint32_t log2_bits_of<nanovdb::Fp16> = 4;

void expect_density(float value, const Int3& voxel) {
  if (value >= 0 && std::isfinite(value)) return;
  throw Error(fmt::format("the value {} in voxel ({}, {}, {}), expected finite ones, at least 0",
                          value, voxel.x, voxel.y, voxel.z));
}

/// The grid's bytes are its own.
template <class Node>
Node& writable(const Node* node) {
  return const_cast<Node&>(*node);
}

/// As sparse_tree_nanovdb.h reads leaves: they say how many bits their values have, and what is
/// not active is 0. Throws Error for a value that a grid may not have.
template <class Build>
void unify(const Tree<Build>& tree) {
  tbb::parallel_for(std::size_t{0}, tree.leaves.size(), [&](std::size_t i) {
    const auto& placed = tree.leaves[i];
    auto& leaf = writable(placed.node);
    for (auto voxel = leaf.mValueMask.beginOn(); voxel; ++voxel) {
      expect_density(leaf.getValue(*voxel), placed.low + entry_place(*voxel, 3));
    }
    if constexpr (!std::is_same_v<Build, nanovdb::FpN>) {
      leaf.mFlags = static_cast<std::uint8_t>((leaf.mFlags & 31) | log2_bits_of<Build> << 5);
    }
    if constexpr (std::is_same_v<Build, float>) {
      for (std::uint32_t n = 0; n < 512; ++n) {
        if (!leaf.mValueMask.isOn(n)) leaf.mValues[n] = 0;
      }
    }
  });
  for (const auto& tile : tree.tiles) expect_density(tile.value, tile.low);
  const auto clear = [](const auto& nodes) {
    tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t i) {
      auto& node = writable(nodes[i].node);
      for (std::uint32_t n = 0; n < std::size(node.mTable); ++n) {
        if (!node.mChildMask.isOn(n) && !node.mValueMask.isOn(n)) node.mTable[n].value = 0;
      }
    });
  };
  clear(tree.uppers), clear(tree.lowers);
  auto& root = writable(tree.root);
  for (std::uint32_t i = 0; i < root.mTableSize; ++i) {
    auto& tile = writable(root.tile(i));
    if (!tile.isChild() && !tile.state) tile.value = 0;
  }
}

/// Whether the outermost voxels of the box, around the active ones, are 0.
template <class Build>
bool has_empty_rim(const Tree<Build>& tree, const IndexBox& box) {
  const auto is_inside = [&](const Int3& low, int side) {
    return glm::all(glm::greaterThan(low, box.low)) &&
           glm::all(glm::lessThan(low + (side - 1), box.high));
  };
  const bool tiles_are = std::ranges::all_of(tree.tiles, [&](const auto& tile) {
    return tile.value == 0 || is_inside(tile.low, tile.side);
  });
  return tiles_are && std::ranges::all_of(tree.leaves, [&](const auto& placed) {
           if (is_inside(placed.low, leaf_side)) return true;
           for (auto voxel = placed.node->mValueMask.beginOn(); voxel; ++voxel) {
             const bool is_empty = placed.node->getValue(*voxel) == 0;
             if (!is_empty && !is_inside(placed.low + entry_place(*voxel, 3), 1)) return false;
           }
           return true;
         });
}

/// Values lie at integer coordinates, and in the middles of a dense grid's voxels.
Affine to_world_of(const nanovdb::Map& map, const IndexBox& box) {
  Affine result;
  for (int i = 0; i < 3; ++i) {
    const double* row = &map.mMatD[3 * i];
    double moved = map.mVecD[i];
    for (int j = 0; j < 3; ++j) {
      result.row[i][j] = static_cast<float>(row[j] * static_cast<double>(box.side(j)));
      moved += row[j] * (static_cast<double>(box.low[j]) - 0.5);
    }
    result.row[i].w = static_cast<float>(moved);
  }
  if (!is_invertible(result)) {
    throw Error("a map to the world that has no inverse, expected one that has");
  }
  return result;
}

/// A grid's voxels are not farther out, for coordinates are floats, and not more along an axis.
constexpr int farthest_voxel = 1 << 24, side_most = 1 << 20;

template <class Build>
VolumeData sparse_grid(GridBytes& bytes) {
  const Tree<Build> tree = TreeWalk<Build>(bytes).walk();
  expect_whole(bytes, tree.root_end, tree.levels());
  if (tree.root->mBackground != 0) {
    throw Error(fmt::format("a background of {}, expected 0", tree.root->mBackground));
  }
  const IndexBox box = box_of(tree);
  if (box.is_empty()) throw Error("no active voxels, expected at least one");
  VolumeData volume;
  for (int axis = 0; axis < 3; ++axis) {
    if (box.low[axis] < -farthest_voxel || box.high[axis] > farthest_voxel ||
        box.side(axis) > side_most) {
      throw Error(
          fmt::format("voxels from {} to {} along an axis, expected at most {} from {} to {}",
                      box.low[axis], box.high[axis], side_most, -farthest_voxel, farthest_voxel));
    }
    volume.size[axis] = static_cast<std::uint32_t>(box.side(axis));
    volume.low[axis] = box.low[axis];
  }
  volume.to_world = to_world_of(bytes.at<nanovdb::GridData>(0).mMap, box);
  unify(tree);
  if (!has_empty_rim(tree, box)) widen_by_rim(volume);
  volume.root = static_cast<std::uint32_t>(
      (reinterpret_cast<const std::byte*>(tree.root) - bytes.data()) / alignment);
  volume.nodes = bytes.take();
  return volume;
}

VolumeData sparse_grid_of(const GridEntry& entry) {
  if (entry.size < sizeof(nanovdb::GridData)) {
    throw Error(fmt::format("damaged: a grid of {} bytes, expected at least {}", entry.size,
                            sizeof(nanovdb::GridData)));
  }
  GridBytes bytes = unpack(entry);
  const auto& grid = bytes.at<nanovdb::GridData>(0);
  if (grid.mMagic != magic && grid.mMagic != grid_magic) {
    throw Error("damaged: expected 'NanoVDB' where it begins");
  }
  expect_version(grid.mVersion);
  if (grid.mGridClass == nanovdb::GridClass::LevelSet) {
    throw Error(
        "a level set, expected a fog volume: 'vdb_tool -read a.vdb -ls2fog -write a.nvdb' makes "
        "one of it");
  }
  switch (grid.mGridType) {
    case nanovdb::GridType::Float:
      return sparse_grid<float>(bytes);
    case nanovdb::GridType::Fp4:
      return sparse_grid<nanovdb::Fp4>(bytes);
    case nanovdb::GridType::Fp8:
      return sparse_grid<nanovdb::Fp8>(bytes);
    case nanovdb::GridType::Fp16:
      return sparse_grid<nanovdb::Fp16>(bytes);
    case nanovdb::GridType::FpN:
      return sparse_grid<nanovdb::FpN>(bytes);
    default:
      break;
  }
  throw Error(fmt::format("values of type {}, expected floats, quantized or not",
                          grid.mGridType < nanovdb::GridType::End
                              ? nanovdb::toStr(grid.mGridType)
                              : std::to_string(static_cast<std::uint32_t>(grid.mGridType))));
}

VolumeData decode(std::string_view bytes, const std::string& grid, VolumeStorage storage) {
  const std::vector<GridEntry> entries = entries_of(bytes);
  const GridEntry& entry = choose_entry(entries, grid);
  return explaining("grid '" + entry.name + "'",
                    [&] { return stored_as(storage, sparse_grid_of(entry)); });
}

}  // namespace

bool reads_nanovdb() { return true; }

VolumeData decode_nanovdb(std::string_view bytes, const std::string& grid, const std::string& name,
                          VolumeStorage storage) {
  return explaining("cannot read " + name, [&] { return decode(bytes, grid, storage); });
}

VolumeData read_nanovdb(const std::filesystem::path& path, const std::string& grid,
                        VolumeStorage storage) {
  return explaining("cannot read " + path.string(),
                    [&] { return decode(WholeFile(path).bytes(), grid, storage); });
}

bool has_nanovdb_grid(const std::filesystem::path& path, const std::string& grid) {
  return explaining("cannot read " + path.string(), [&] {
    return find_entry(entries_of(WholeFile(path).bytes()), grid) != nullptr;
  });
}

}  // namespace pt
