// What a .nvdb file holds: segments of grids, and the tree of a grid.
#pragma once

#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/IO.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/error/error.h"
#include "common/medium/volume_grid.h"

namespace pt::nanovdb_files {

/// Begins a grid; files of later versions begin with other numbers.
inline constexpr std::uint64_t magic = NANOVDB_MAGIC_NUMBER;
inline constexpr std::uint64_t grid_magic = 0x314244566f6e614e;  // "NanoVDB1"

struct GridEntry {
  std::string name;
  nanovdb::io::Codec codec;
  std::uint64_t size;     ///< in bytes, unpacked
  std::string_view data;  ///< as it is in the file
};

inline constexpr std::size_t alignment = NANOVDB_DATA_ALIGNMENT;
static_assert(sizeof(SparseBlock) == alignment);

/// As NanoVDB's structures must lie.
class GridBytes {
 public:
  explicit GridBytes(std::uint64_t size)
      : size_(size), blocks_((size + alignment - 1) / alignment) {}

  std::byte* data() { return reinterpret_cast<std::byte*>(blocks_.data()); }
  const std::byte* data() const { return reinterpret_cast<const std::byte*>(blocks_.data()); }
  std::uint64_t size() const { return size_; }
  std::vector<SparseBlock> take() { return std::move(blocks_); }

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
  std::vector<SparseBlock> blocks_;
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

/// A node; what follows its head belongs to it, too.
struct NodeBytes {
  const std::byte* begin;
  std::uint64_t head, size;
};

/// From the root's children to the leaves.
using NodeLevels = std::array<std::vector<NodeBytes>, 3>;

/// Throws Error where nodes overlap, since what is written into one is to change no other, or where
/// the checksums are others: the CRC-32 of the grid's head, up to `root_end`, and that of the
/// CRC-32s of all nodes' heads.
void expect_whole(const GridBytes& bytes, std::uint64_t root_end, NodeLevels levels);

// A grid's tree: walked by offsets that are checked, its nodes listed, its checksums. The place of
// a node is that of its entry in its parent.

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
inline Int3 entry_place(std::uint32_t n, int log2_side) {
  const std::uint32_t mask = (1u << log2_side) - 1;
  return Int3(n >> 2 * log2_side, n >> log2_side & mask, n & mask);
}

inline constexpr int leaf_side = 8, lower_side = 128, upper_side = 4096;  // in voxels

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

  NodeLevels levels() const {
    NodeLevels result;
    const auto fill = [](std::vector<NodeBytes>& level, const auto& nodes) {
      for (const auto& [node, low] : nodes)
        level.push_back({reinterpret_cast<const std::byte*>(node), sizeof *node, node->memUsage()});
    };
    fill(result[0], uppers), fill(result[1], lowers), fill(result[2], leaves);
    return result;
  }
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
    if (root_at < tree_at + sizeof(tree)) throw Error("damaged: a root in its grid's head");
    const std::uint64_t tiles_at = root_at + sizeof(Root);
    const std::uint64_t tiles_size = std::uint64_t{root.mTableSize} * sizeof(RootTile);
    bytes_.at<RootTile>(tiles_at, tiles_size);
    tree_.root = &root, tree_.root_end = tiles_at + tiles_size;
    std::set<std::uint64_t> keys;
    for (std::uint32_t i = 0; i < root.mTableSize; ++i) {
      const RootTile& tile = *root.tile(i);
      const nanovdb::Coord origin = tile.origin();
      if (!keys.insert(tile.key).second || tile.key != Root::CoordToKey(origin)) {
        throw Error("damaged: two nodes in the same place");
      }
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
inline void grow_by_leaf(const void* mask, const Int3& low, IndexBox& box) {
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

}  // namespace pt::nanovdb_files
