// NanoVDB's files of tests/data/nanovdb, and ways to damage them. OpenVDB's vdb_tool 10.6.1
// (Debian: libopenvdb-tools) wrote them:
//
//   balls="-sphere radius=1 voxel=0.125 center=(3,4,5)
//          -sphere radius=0.75 voxel=0.125 center=(4,4.25,5) -union"
//   vdb_tool $balls -ls2fog name=density -write codec=zip balls.nvdb
//   vdb_tool $balls -ls2fog name=density -write codec=blosc checksum=full balls_blosc.nvdb
//   vdb_tool $balls -ls2fog name=density
//       -write codec=zip checksum=full bits=4 tolerance=0.01 balls_fp4.nvdb  # 8, 16, N
//   vdb_tool $balls -ls2fog name=density -sphere radius=1.25 voxel=0.25 'center=(3.25,4,5)'
//       -ls2fog name=temperature -write codec=zip two.nvdb
//   vdb_tool -sphere radius=1.5 voxel=0.125 'center=(4.4375,4.4375,4.4375)' -ls2fog name=smoke
//       -write codec=zip tile.nvdb
//   vdb_tool -sphere radius=1 voxel=0.125 'center=(3,4,5)' name=ball
//       -write codec=zip level_set.nvdb
//   vdb_tool -sphere radius=0.5 voxel=0.125 'center=(3,4,5)' -grad -write codec=zip vectors.nvdb
#pragma once

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <string>

#include "common/scene/load/files/volumes/volume_files.h"
#include "temp_folder.h"
#include "test_data.h"

namespace pt {

inline std::string nanovdb_path(const std::string& name) { return test_data("nanovdb/" + name); }
inline std::string nanovdb_bytes(const std::string& name) { return read_text(nanovdb_path(name)); }

class NanovdbTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!reads_nanovdb()) GTEST_SKIP() << "built without NanoVDB";
  }
};

/// A file of one grid that was packed by zip, unpacked. By NanoVDB's documentation of its layout.
class UnpackedNanovdb {
 public:
  // In the file.
  static constexpr std::size_t version_at = 8, codec_at = 14;
  // In the grid.
  static constexpr std::size_t checksum_at = 8, grid_version_at = 16, matrix_at = 384;

  explicit UnpackedNanovdb(const std::string& name) : bytes(nanovdb_bytes(name)) {
    constexpr std::size_t meta_at = 16, meta_size = 176, name_size_at = meta_at + 136;
    const auto size = at<std::uint64_t>(meta_at);
    grid = meta_at + meta_size + at<std::uint32_t>(name_size_at);
    const std::string packed = bytes.substr(grid + sizeof(std::uint64_t));
    bytes.resize(grid + size);
    uLongf length = size;
    uncompress(reinterpret_cast<Bytef*>(&bytes[grid]), &length,
               reinterpret_cast<const Bytef*>(packed.data()), packed.size());
    put<std::uint16_t>(codec_at, 0);
    put<std::uint64_t>(meta_at + sizeof size, size);
    const std::size_t tree = grid + 672;
    leaf = tree + at<std::uint64_t>(tree), lower = tree + at<std::uint64_t>(tree + 8);
    upper = tree + at<std::uint64_t>(tree + 16), root = tree + at<std::uint64_t>(tree + 24);
  }

  /// Its changes are seen by their effect alone.
  UnpackedNanovdb& without_checksum() { return put<std::uint64_t>(grid + checksum_at, ~0ull); }

  template <class T>
  T at(std::size_t place) const {
    T value;
    std::memcpy(&value, &bytes.at(place), sizeof value);
    return value;
  }
  template <class T>
  UnpackedNanovdb& put(std::size_t place, T value) {
    std::memcpy(&bytes.at(place), &value, sizeof value);
    return *this;
  }

  /// The entry for the first child of an internal node with so many entries.
  std::size_t first_child(std::size_t node, std::size_t entries) const {
    const std::size_t mask = node + 32 + entries / 8;
    std::size_t n = 0;
    while ((at<std::uint8_t>(mask + n / 8) >> n % 8 & 1) == 0) ++n;
    const std::size_t head = (32 + 2 * entries / 8 + 16 + 31) / 32 * 32;
    return node + head + 8 * n;
  }

  std::string bytes;
  std::size_t grid, root, upper, lower, leaf;  ///< the first of each
};

}  // namespace pt
