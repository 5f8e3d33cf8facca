// NanoVDB's own readers trust a file. Here its structures are only laid over bytes once these are
// known to hold them: a tree is walked by offsets that are checked, and the place of a node is that
// of its entry in its parent.
#include "common/scene/load/files/volumes/nanovdb_file.h"

#include <blosc.h>
#include <fmt/format.h>
#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/IO.h>
#include <tbb/parallel_for.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <set>

#include "common/error/error_context.h"
#include "common/error/host_memory.h"
#include "common/scene/load/files/mapped_file.h"

namespace pt {
namespace {

// ---- The file: segments, each of a header, one MetaData and a name for each grid, and the grids.

constexpr std::uint64_t magic = NANOVDB_MAGIC_NUMBER;        // of files and grids
constexpr std::uint64_t file_magic = 0x324244566f6e614e;     // "NanoVDB2", of later versions
constexpr std::uint64_t grid_magic = 0x314244566f6e614e;     // "NanoVDB1"
constexpr std::uint64_t openvdb_magic = 0x0000000056444220;  // of OpenVDB's files
constexpr std::uint32_t major_version = NANOVDB_MAJOR_VERSION_NUMBER;
constexpr std::uint32_t last_known_minor = 5;  // later ones have other checksums
/// Of a byte of a compressed file: deflate's; blosc's LZ4 has 255.
constexpr std::uint64_t most_packed = 1032;

struct GridEntry {
  std::string name;
  nanovdb::io::Codec codec;
  std::uint64_t size;     ///< in bytes, unpacked
  std::string_view data;  ///< as it is in the file
};

/// Reads one thing after the other from bytes that may end too early.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  bool at_end() const { return rest_.empty(); }

  std::string_view take(std::uint64_t size, const char* what) {
    if (size > rest_.size()) {
      throw Error(fmt::format("truncated: {} bytes of {}, expected {}", rest_.size(), what, size));
    }
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }

  template <class T>
  void read(T& value, const char* what) {
    std::memcpy(static_cast<void*>(&value), take(sizeof value, what).data(), sizeof value);
  }

 private:
  std::string_view rest_;
};

void expect_version(const nanovdb::Version& version) {
  if (version.getMajor() == major_version) return;
  throw Error(fmt::format("version {}.{}.{} of the format, expected {}", version.getMajor(),
                          version.getMinor(), version.getPatch(), major_version));
}

void expect_nanovdb(std::uint64_t first_bytes, bool is_first) {
  if (first_bytes == magic || first_bytes == file_magic) return;
  if (!is_first) throw Error("damaged: expected the end or 'NanoVDB' behind its grids");
  if (first_bytes == openvdb_magic) {
    throw Error(
        "a file of OpenVDB, expected one of NanoVDB: 'vdb_tool -read a.vdb -write a.nvdb' "
        "converts it");
  }
  throw Error("not a .nvdb file: expected 'NanoVDB' at its beginning");
}

std::vector<GridEntry> entries_of(std::string_view bytes) {
  ByteReader reader(bytes);
  std::vector<GridEntry> entries;
  bool is_first = true;
  do {
    std::uint64_t first_bytes = 0;
    if (bytes.size() >= sizeof first_bytes) {
      reader.read(first_bytes, "a header");
    }
    expect_nanovdb(first_bytes, is_first);
    is_first = false;
    struct {
      nanovdb::Version version;
      std::uint16_t grids;
      std::uint16_t codec;
    } header;
    reader.read(header, "a header");
    expect_version(header.version);
    if (header.codec >= static_cast<std::uint16_t>(nanovdb::io::Codec::END)) {
      throw Error(fmt::format("codec {}, expected 0, 1 or 2: none, zip or blosc", header.codec));
    }
    std::vector<std::uint64_t> sizes;
    const std::size_t first = entries.size();
    for (int i = 0; i < header.grids; ++i) {
      nanovdb::io::MetaData meta;
      reader.read(meta, "what describes a grid");
      const std::string_view name = reader.take(meta.nameSize, "a grid's name");
      entries.push_back({std::string(name.substr(0, name.find('\0'))),
                         static_cast<nanovdb::io::Codec>(header.codec),
                         meta.gridSize,
                         {}});
      sizes.push_back(meta.fileSize);
    }
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      entries[first + i].data = reader.take(sizes[i], "a grid");
    }
  } while (!reader.at_end());
  return entries;
}

std::string names_of(const std::vector<GridEntry>& entries) {
  std::string names;
  for (const GridEntry& entry : entries) {
    names += fmt::format("{}'{}'", names.empty() ? "" : ", ", entry.name);
  }
  return names.empty() ? "none" : names;
}

const GridEntry* find_entry(const std::vector<GridEntry>& entries, const std::string& name) {
  const auto found = std::ranges::find(entries, name, &GridEntry::name);
  return found == entries.end() ? nullptr : &*found;
}

const GridEntry& choose_entry(const std::vector<GridEntry>& entries, const std::string& name) {
  const std::string wanted = name.empty() ? "density" : name;
  if (const GridEntry* entry = find_entry(entries, wanted)) return *entry;
  if (name.empty() && entries.size() == 1) return entries.front();
  throw Error(fmt::format("no grid '{}'; expected one of: {}", wanted, names_of(entries)));
}

// ---- A grid's bytes.

constexpr std::size_t alignment = NANOVDB_DATA_ALIGNMENT;

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

void unzip(ByteReader& reader, GridBytes& bytes) {
  std::uint64_t packed_size = 0;
  reader.read(packed_size, "a packed grid");
  const std::string_view packed = reader.take(packed_size, "a packed grid");
  uLongf size = bytes.size();
  const int status = uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                                reinterpret_cast<const Bytef*>(packed.data()), packed.size());
  if (status != Z_OK || size != bytes.size()) {
    throw Error(fmt::format("damaged: expected {} bytes packed by zip", bytes.size()));
  }
}

void unpack_blosc(ByteReader& reader, GridBytes& bytes) {
  constexpr std::uint64_t most_at_once = std::uint64_t{1} << 30;  // NanoVDB's
  for (std::uint64_t done = 0; done < bytes.size();) {
    const std::uint64_t expected = std::min(bytes.size() - done, most_at_once);
    std::uint64_t packed_size = 0;
    reader.read(packed_size, "a packed grid");
    const std::string_view packed = reader.take(packed_size, "a packed grid");
    std::size_t size = 0;
    const bool is_whole = blosc_cbuffer_validate(packed.data(), packed.size(), &size) == 0;
    if (!is_whole || size != expected ||
        blosc_decompress_ctx(packed.data(), bytes.data() + done, expected, 1) !=
            static_cast<int>(expected)) {
      throw Error(fmt::format("damaged: expected {} bytes packed by blosc", expected));
    }
    done += expected;
  }
}

GridBytes unpack(const GridEntry& entry) {
  if (entry.size / most_packed > entry.data.size()) {  // nothing is allocated for a lie
    throw Error(fmt::format("damaged: {} bytes, expected those of a grid of {}", entry.data.size(),
                            entry.size));
  }
  check_host_memory(entry.size, "the sparse grid");
  GridBytes bytes(entry.size);
  ByteReader reader(entry.data);
  switch (entry.codec) {
    case nanovdb::io::Codec::ZIP:
      unzip(reader, bytes);
      break;
    case nanovdb::io::Codec::BLOSC:
      unpack_blosc(reader, bytes);
      break;
    default:
      std::ranges::copy(std::as_bytes(std::span(reader.take(entry.size, "a grid"))), bytes.data());
  }
  return bytes;
}

// ---- A grid's tree.

using Int3 = glm::ivec3;

/// The box of the active voxels, both corners included.
struct IndexBox {
  Int3 low = Int3(std::numeric_limits<int>::max()), high = Int3(std::numeric_limits<int>::min());

  void grow(const Int3& first, const Int3& last) {
    low = glm::min(low, first), high = glm::max(high, last);
  }
  bool is_empty() const { return low.x > high.x; }
  std::uint64_t side(int axis) const {
    return static_cast<std::uint64_t>(std::int64_t{high[axis]} - low[axis] + 1);
  }
};

/// Entry n of a node of 2^log2_side entries along each axis: z varies fastest.
Int3 entry_place(std::uint32_t n, int log2_side) {
  const std::uint32_t mask = (1u << log2_side) - 1;
  return Int3(n >> 2 * log2_side, n >> log2_side & mask, n & mask);
}

constexpr int leaf_side = 8, lower_side = 128, upper_side = 4096;  // in voxels

template <class Build>
struct Tree {
  using Root = typename nanovdb::NanoRoot<Build>::DataType;
  using Upper = typename nanovdb::NanoUpper<Build>::DataType;
  using Lower = typename nanovdb::NanoLower<Build>::DataType;
  using Leaf = typename nanovdb::NanoLeaf<Build>::DataType;

  template <class Node>
  struct Placed {
    const Node* node;
    Int3 low;
  };
  /// A cube of voxels of one value, all of them active.
  struct Tile {
    float value;
    Int3 low;
    int side;
  };

  const Root* root;
  std::uint64_t root_end;  ///< in the grid's bytes
  std::vector<Placed<Upper>> uppers;
  std::vector<Placed<Lower>> lowers;
  std::vector<Placed<Leaf>> leaves;
  std::vector<Tile> tiles;
};

template <class Build>
class TreeWalk {
 public:
  explicit TreeWalk(const GridBytes& bytes) : bytes_(bytes) {}

  Tree<Build> walk() {
    constexpr std::uint64_t tree_at = sizeof(nanovdb::GridData);
    const auto& tree = bytes_.at<nanovdb::TreeData<3>>(tree_at);
    const std::uint64_t root_at = tree_at + tree.mNodeOffset[3];
    const Root& root = bytes_.at<Root>(root_at);
    const std::uint64_t tiles_at = root_at + sizeof(Root);
    const std::uint64_t tiles_size = std::uint64_t{root.mTableSize} * sizeof(RootTile);
    bytes_.at<RootTile>(tiles_at, tiles_size);
    tree_.root = &root, tree_.root_end = tiles_at + tiles_size;
    std::set<std::uint64_t> keys;
    for (std::uint32_t i = 0; i < root.mTableSize; ++i) {
      const RootTile& tile = *root.tile(i);
      if (!keys.insert(tile.key).second) throw Error("damaged: two nodes in the same place");
      const nanovdb::Coord origin = tile.origin();
      const Int3 low(origin[0], origin[1], origin[2]);
      if (tile.isChild()) {
        add(tree_.uppers, &root, tile.child, low);
      } else if (tile.state) {
        tree_.tiles.push_back({tile.value, low, upper_side});
      }
    }
    for (const auto& upper : tree_.uppers) add_entries(upper, tree_.lowers, 5, lower_side);
    for (const auto& lower : tree_.lowers) add_entries(lower, tree_.leaves, 4, leaf_side);
    return std::move(tree_);
  }

 private:
  using T = Tree<Build>;
  using Root = typename T::Root;
  using RootTile = typename Root::Tile;

  template <class Node>
  void add(std::vector<typename T::template Placed<Node>>& nodes, const void* parent,
           std::int64_t offset, const Int3& low) {
    const auto parent_at =
        static_cast<std::uint64_t>(static_cast<const std::byte*>(parent) - bytes_.data());
    const std::uint64_t at = parent_at + static_cast<std::uint64_t>(offset);
    const Node& node = bytes_.at<Node>(at);
    if constexpr (std::is_same_v<Node, typename nanovdb::NanoLeaf<nanovdb::FpN>::DataType>) {
      constexpr int log2_most_bits = 4;
      if (node.mFlags >> 5 > log2_most_bits) throw Error("damaged: codes of more than 16 bits");
      bytes_.at<Node>(at, node.memUsage());
    }
    // A tree has each node once, or the walk would not end in time.
    if (nodes.size() == bytes_.size() / sizeof(Node)) throw Error("damaged: nodes used twice");
    nodes.push_back({&node, low});
  }

  template <class Parent, class Child>
  void add_entries(const Parent& parent, std::vector<Child>& children, int log2_side,
                   int entry_side) {
    const auto& node = *parent.node;
    const auto low_of = [&](std::uint32_t n) {
      return parent.low + entry_side * entry_place(n, log2_side);
    };
    for (auto entry = node.mChildMask.beginOn(); entry; ++entry) {
      add(children, &node, node.mTable[*entry].child, low_of(*entry));
    }
    for (auto entry = node.mValueMask.beginOn(); entry; ++entry) {
      if (node.mChildMask.isOn(*entry)) continue;
      tree_.tiles.push_back({node.mTable[*entry].value, low_of(*entry), entry_side});
    }
  }

  const GridBytes& bytes_;
  T tree_{};
};

/// By the mask of a leaf: a bit for each voxel, a word for each x, of which a byte for each y.
void grow_by_leaf(const void* mask, const Int3& low, IndexBox& box) {
  std::uint64_t words[leaf_side], yz = 0;
  std::memcpy(words, mask, sizeof words);
  int x_first = leaf_side, x_last = 0;
  for (int x = 0; x < leaf_side; ++x) {
    if (words[x] == 0) continue;
    x_first = std::min(x_first, x), x_last = x, yz |= words[x];
  }
  if (yz == 0) return;
  std::uint64_t z = yz | yz >> 32;
  z |= z >> 16, z |= z >> 8;
  const auto z_bits = static_cast<std::uint8_t>(z);
  box.grow(low + Int3(x_first, std::countr_zero(yz) / 8, std::countr_zero(z_bits)),
           low + Int3(x_last, 7 - std::countl_zero(yz) / 8, 7 - std::countl_zero(z_bits)));
}

template <class Build>
IndexBox box_of(const Tree<Build>& tree) {
  IndexBox box;
  for (const auto& leaf : tree.leaves) grow_by_leaf(&leaf.node->mValueMask, leaf.low, box);
  for (const auto& tile : tree.tiles) box.grow(tile.low, tile.low + (tile.side - 1));
  return box;
}

// ---- Checksums: CRC-32 of the head, up to the root's table, and of the CRC-32s of all nodes.

constexpr std::uint32_t no_checksum = 0xffffffff;

std::uint32_t checksum(const void* data, std::size_t size) {
  return static_cast<std::uint32_t>(crc32_z(0, static_cast<const Bytef*>(data), size));
}

template <class Nodes>
void add_checksums(const Nodes& nodes, std::vector<std::uint64_t>& sums) {
  const std::size_t first = sums.size();
  sums.resize(first + nodes.size());
  tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t i) {
    sums[first + i] = checksum(nodes[i].node, sizeof *nodes[i].node);
  });
}

template <class Build>
void expect_checksums(const GridBytes& bytes, Tree<Build>& tree) {
  const auto& grid = bytes.at<nanovdb::GridData>(0);
  if (grid.mVersion.getMinor() > last_known_minor) return;
  const auto head = static_cast<std::uint32_t>(grid.mChecksum);
  const auto nodes = static_cast<std::uint32_t>(grid.mChecksum >> 32);
  constexpr std::size_t first = 16;  // behind the magic number and the checksum
  if (head == no_checksum) return;
  bool is_right = head == checksum(bytes.data() + first, tree.root_end - first);
  if (is_right && nodes != no_checksum && !tree.uppers.empty()) {
    if (grid.mFlags & static_cast<std::uint32_t>(nanovdb::GridFlags::IsBreadthFirst)) {
      const auto sort = [](auto& level) {
        std::ranges::sort(level, {}, [](const auto& placed) { return placed.node; });
      };
      sort(tree.uppers), sort(tree.lowers), sort(tree.leaves);
    }
    std::vector<std::uint64_t> sums;
    add_checksums(tree.uppers, sums), add_checksums(tree.lowers, sums);
    add_checksums(tree.leaves, sums);
    is_right = nodes == checksum(sums.data(), sums.size() * sizeof sums[0]);
  }
  if (!is_right) throw Error("damaged: its checksum is another");
}

// ---- The dense grid.

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
                    [&] { return decode(MappedFile(path).bytes(), grid); });
}

bool has_nanovdb_grid(const std::filesystem::path& path, const std::string& grid) {
  return explaining("cannot read " + path.string(), [&] {
    return find_entry(entries_of(MappedFile(path).bytes()), grid) != nullptr;
  });
}

}  // namespace pt
