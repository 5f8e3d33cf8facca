// A file of NanoVDB: segments, each of a header, one MetaData and a name for each grid, and the
// grids.
#pragma once

#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/IO.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/error/error.h"

namespace pt::nanovdb_files {

/// Of grids; files of later versions begin with other numbers.
inline constexpr std::uint64_t magic = NANOVDB_MAGIC_NUMBER;
inline constexpr std::uint64_t grid_magic = 0x314244566f6e614e;  // "NanoVDB1"

struct GridEntry {
  std::string name;
  nanovdb::io::Codec codec;
  std::uint64_t size;     ///< in bytes, unpacked
  std::string_view data;  ///< as it is in the file
};

inline constexpr std::size_t alignment = NANOVDB_DATA_ALIGNMENT;

struct alignas(alignment) Block {
  std::byte bytes[alignment];
};

/// As NanoVDB's structures must lie.
class GridBytes {
 public:
  explicit GridBytes(std::uint64_t size)
      : size_(size), blocks_((size + alignment - 1) / alignment) {}

  std::byte* data() { return reinterpret_cast<std::byte*>(blocks_.data()); }
  const std::byte* data() const { return reinterpret_cast<const std::byte*>(blocks_.data()); }
  std::uint64_t size() const { return size_; }

  /// What begins at `position`, of `size` bytes at least. Throws Error where there is none.
  template <class T>
  const T& at(std::uint64_t position, std::uint64_t size = sizeof(T)) const {
    if (size > size_ || position > size_ - size || position % alignment != 0) {
      throw Error("damaged: a node outside of its grid");
    }
    return *reinterpret_cast<const T*>(data() + position);
  }

 private:
  std::uint64_t size_;
  std::vector<Block> blocks_;
};

/// The grids of a file, in its order; they refer to `bytes`. Throws Error where it is none.
std::vector<GridEntry> entries_of(std::string_view bytes);

/// Null: there is none of this name.
const GridEntry* find_entry(const std::vector<GridEntry>& entries, const std::string& name);

/// That of a name; an empty one is "density" or else the only grid. Throws Error, which lists the
/// file's grids, where there is none.
const GridEntry& choose_entry(const std::vector<GridEntry>& entries, const std::string& name);

/// Throws Error for a version of which nothing is known.
void expect_version(const nanovdb::Version& version);

/// Throws Error where the grid is damaged.
GridBytes unpack(const GridEntry& entry);

}  // namespace pt::nanovdb_files
