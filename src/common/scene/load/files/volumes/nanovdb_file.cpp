// NanoVDB's own readers trust a file. Here its structures are only laid over bytes once these are
// known to hold them.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/scene/load/files/volumes/nanovdb.h"
#include "common/scene/load/files/volumes/volume_files.h"
#include "common/scene/load/files/whole_file.h"

namespace pt {

using namespace nanovdb_files;

namespace {

/// Writes voxels, which may be done in parallel.
class DenseFill {
 public:
  DenseFill(VolumeData& volume, const Int3& low) : volume_(volume), low_(low) {}

  /// `count` voxels of one value from `first` on, along x.
  void put(const Int3& first, int count, float value) {
    if (!(value >= 0) || !std::isfinite(value)) {
      throw Error(
          fmt::format("the value {} in voxel ({}, {}, {}), expected finite ones, at least 0", value,
                      first.x, first.y, first.z));
    }
    const Int3 at = first - low_;
    const std::size_t row =
        static_cast<std::size_t>(at.z) * volume_.size[1] + static_cast<std::size_t>(at.y);
    std::fill_n(&volume_.values[row * volume_.size[0] + static_cast<std::size_t>(at.x)], count,
                value);
  }

 private:
  VolumeData& volume_;
  Int3 low_;
};

template <class Build>
void fill(const Tree<Build>& tree, DenseFill dense) {
  tbb::parallel_for(std::size_t{0}, tree.leaves.size(), [&](std::size_t i) {
    const auto& [leaf, low] = tree.leaves[i];
    for (auto voxel = leaf->mValueMask.beginOn(); voxel; ++voxel) {
      dense.put(low + entry_place(*voxel, 3), 1, leaf->getValue(*voxel));
    }
  });
  for (const auto& tile : tree.tiles) {
    tbb::parallel_for(0, tile.side, [&](int z) {
      for (int y = 0; y < tile.side; ++y)
        dense.put(tile.low + Int3(0, y, z), tile.side, tile.value);
    });
  }
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
  const float determinant = result.determinant();
  if (!std::isfinite(determinant) || determinant == 0) {
    throw Error("a map to the world that has no inverse, expected one that has");
  }
  return result;
}

/// Zeros where nothing is active.
VolumeData empty_volume(const IndexBox& box) {
  VolumeData volume;
  constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
  std::uint64_t voxels = 1, with_rim = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint64_t side = box.side(axis);
    if (side + 2 > most / with_rim) {
      throw Error(
          fmt::format("{} x {} x {} voxels around its active ones, expected at most {} in a dense "
                      "grid",
                      box.side(0), box.side(1), box.side(2), most));
    }
    volume.size[axis] = static_cast<std::uint32_t>(side);
    voxels *= side, with_rim *= side + 2;
  }
  check_host_memory((voxels + with_rim) * sizeof(float), "the dense grid");
  volume.values.assign(voxels, 0.0f);
  return volume;
}

template <class Build>
VolumeData dense_grid(const GridBytes& bytes) {
  Tree<Build> tree = TreeWalk<Build>(bytes).walk();
  expect_checksums(bytes, tree);
  if (tree.root->mBackground != 0) {
    throw Error(fmt::format("a background of {}, expected 0", tree.root->mBackground));
  }
  const IndexBox box = box_of(tree);
  if (box.is_empty()) throw Error("no active voxels, expected at least one");
  VolumeData volume = empty_volume(box);
  volume.to_world = to_world_of(bytes.at<nanovdb::GridData>(0).mMap, box);
  fill(tree, DenseFill(volume, box.low));
  if (has_empty_rim(volume.size, volume.channels, volume.values.data())) return volume;
  return with_rim_of_zeros(volume);
}

VolumeData dense_grid_of(const GridEntry& entry) {
  if (entry.size < sizeof(nanovdb::GridData)) {
    throw Error(fmt::format("damaged: a grid of {} bytes, expected at least {}", entry.size,
                            sizeof(nanovdb::GridData)));
  }
  const GridBytes bytes = unpack(entry);
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
      return dense_grid<float>(bytes);
    case nanovdb::GridType::Fp4:
      return dense_grid<nanovdb::Fp4>(bytes);
    case nanovdb::GridType::Fp8:
      return dense_grid<nanovdb::Fp8>(bytes);
    case nanovdb::GridType::Fp16:
      return dense_grid<nanovdb::Fp16>(bytes);
    case nanovdb::GridType::FpN:
      return dense_grid<nanovdb::FpN>(bytes);
    default:
      break;
  }
  throw Error(fmt::format("values of type {}, expected floats, quantized or not",
                          grid.mGridType < nanovdb::GridType::End
                              ? nanovdb::toStr(grid.mGridType)
                              : std::to_string(static_cast<std::uint32_t>(grid.mGridType))));
}

VolumeData decode(std::string_view bytes, const std::string& grid) {
  const std::vector<GridEntry> entries = entries_of(bytes);
  const GridEntry& entry = choose_entry(entries, grid);
  return explaining("grid '" + entry.name + "'", [&] { return dense_grid_of(entry); });
}

}  // namespace

bool reads_nanovdb() { return true; }

VolumeData decode_nanovdb(std::string_view bytes, const std::string& grid,
                          const std::string& name) {
  return explaining("cannot read " + name, [&] { return decode(bytes, grid); });
}

VolumeData read_nanovdb(const std::filesystem::path& path, const std::string& grid) {
  return explaining("cannot read " + path.string(),
                    [&] { return decode(WholeFile(path).bytes(), grid); });
}

bool has_nanovdb_grid(const std::filesystem::path& path, const std::string& grid) {
  return explaining("cannot read " + path.string(), [&] {
    return find_entry(entries_of(WholeFile(path).bytes()), grid) != nullptr;
  });
}

}  // namespace pt
