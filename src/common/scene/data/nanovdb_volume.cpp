// Trees of NanoVDB: all of their voxels, and trees that are made.
#include <nanovdb/NanoVDB.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <tuple>

#include "common/error/host_memory.h"
#include "common/medium/sparse_tree_nanovdb.h"
#include "common/scene/data/volume_data.h"

namespace pt {
namespace {

using Int3 = glm::ivec3;
using Root = SparseRoot::DataType;
using Upper = nanovdb::NanoUpper<nanovdb::FpN>::DataType;
using Lower = nanovdb::NanoLower<nanovdb::FpN>::DataType;
constexpr int leaf_side = 8, lower_side = 128, upper_side = 4096, leaf_voxels = 512;

struct PlacedLeaf {
  const SparseLeaf* leaf;
  Int3 low;
};

/// Entry n of a node of 2^log2_side entries along each axis: z varies fastest.
Int3 entry_place(std::uint32_t n, int log2_side) {
  const std::uint32_t mask = (1u << log2_side) - 1;
  return Int3(n >> 2 * log2_side, n >> log2_side & mask, n & mask);
}

/// Lists a tree's leaves, and tiles that are not 0.
class BrickList {
 public:
  explicit BrickList(const SparseBlock* root_block) {
    const Root& root = *reinterpret_cast<const Root*>(root_block);
    for (std::uint32_t i = 0; i < root.mTableSize; ++i) {
      const auto& tile = *root.tile(i);
      const nanovdb::Coord origin = tile.origin();
      const Int3 low(origin[0], origin[1], origin[2]);
      if (tile.isChild()) {
        add(*root.getChild(&tile)->data(), low, 5, lower_side);
      } else {
        add_tile(tile.value, low, upper_side);
      }
    }
  }

  std::vector<PlacedLeaf> leaves;
  std::vector<SparseBrick> tiles;
  std::vector<const float*> tile_values;

 private:
  void add_tile(const float& value, const Int3& low, int side) {
    if (value == 0) return;
    tiles.push_back({low, side, nullptr, value}), tile_values.push_back(&value);
  }

  template <class Node>
  void add(const Node& node, const Int3& node_low, int log2_side, int side) {
    for (std::uint32_t n = 0; n < 1u << 3 * log2_side; ++n) {
      const Int3 low = node_low + side * entry_place(n, log2_side);
      if (!node.mChildMask.isOn(n)) {
        add_tile(node.mTable[n].value, low, side);
      } else if constexpr (std::is_same_v<Node, Upper>) {
        add(*node.getChild(n)->data(), low, 4, leaf_side);
      } else {
        leaves.push_back({node.getChild(n), low});
      }
    }
  }
};

/// Of the nodes of 2^log2_side entries of `entry_side` voxels, that which has a place: its number
/// among all, and the entry there.
struct NodeLevel {
  std::vector<Int3> origins;  ///< sorted
  int log2_side, entry_side;

  NodeLevel(std::span<const Int3> places, int log2_entries, int side_of_entry)
      : log2_side(log2_entries), entry_side(side_of_entry) {
    for (const Int3& place : places) origins.push_back(origin(place));
    std::ranges::sort(origins, {}, key);
    origins.erase(std::unique(origins.begin(), origins.end()), origins.end());
  }

  static std::tuple<int, int, int> key(const Int3& p) { return {p.x, p.y, p.z}; }
  Int3 origin(const Int3& place) const { return place - place % (entry_side << log2_side); }
  std::size_t number(const Int3& place) const {
    const auto found = std::ranges::lower_bound(origins, key(origin(place)), {}, key);
    return static_cast<std::size_t>(found - origins.begin());
  }
  std::uint32_t entry(const Int3& place) const {
    const Int3 at = (place - origin(place)) / entry_side;
    return static_cast<std::uint32_t>((at.x << log2_side | at.y) << log2_side | at.z);
  }
};

}  // namespace

void for_each_brick(const SparseBlock* root,
                    const std::function<void(const SparseBrick&)>& function) {
  const BrickList bricks(root);
  tbb::parallel_for(std::size_t{0}, bricks.leaves.size(), [&](std::size_t i) {
    std::array<float, leaf_voxels> values;
    for (std::uint32_t n = 0; n < leaf_voxels; ++n) values[n] = value_in(*bricks.leaves[i].leaf, n);
    function({bricks.leaves[i].low, leaf_side, values.data(), 0.0f});
  });
  for (const SparseBrick& tile : bricks.tiles) function(tile);
}

bool number_voxels(VolumeData& volume, std::vector<float>& values) {
  const BrickList bricks(&volume.nodes[volume.root]);
  for (const auto& [leaf, low] : bricks.leaves) {
    if (leaf->data()->mFlags >> 5 != log2_float_bits) return false;
  }
  values.assign(1, 0.0f);
  const auto number = [&](const float* of_tree) {
    auto& value = const_cast<float&>(*of_tree);  // the tree is the volume's
    if (value == 0) return;
    values.push_back(value);
    value = bits_to_float(static_cast<std::uint32_t>(values.size() - 1));
  };
  for (const auto& [leaf, low] : bricks.leaves) {
    const auto* const voxels = reinterpret_cast<const float*>(leaf + 1);
    for (int n = 0; n < leaf_voxels; ++n) number(voxels + n);
  }
  for (const float* value : bricks.tile_values) number(value);
  return true;
}

VolumeData make_sparse(std::uint32_t side, std::span<const Int3> places,
                       const std::function<void(std::size_t, float*)>& fill) {
  using Leaf = nanovdb::NanoLeaf<float>::DataType;
  const NodeLevel uppers(places, 5, lower_side), lowers(places, 4, leaf_side);
  constexpr std::uint64_t root_at = sizeof(SparseBlock);
  const std::uint64_t uppers_at =
      root_at + sizeof(Root) + uppers.origins.size() * sizeof(Root::Tile);
  const std::uint64_t lowers_at = uppers_at + uppers.origins.size() * sizeof(Upper);
  const std::uint64_t leaves_at = lowers_at + lowers.origins.size() * sizeof(Lower);
  const std::uint64_t size = leaves_at + places.size() * sizeof(Leaf);
  check_host_memory(size, "the sparse grid");
  VolumeData volume;
  std::fill(std::begin(volume.size), std::end(volume.size), side);
  volume.nodes.resize(size / sizeof(SparseBlock));
  volume.root = root_at / sizeof(SparseBlock);
  std::byte* const bytes = volume.nodes[0].bytes;
  auto& root = *reinterpret_cast<Root*>(bytes + root_at);
  auto* const upper_nodes = reinterpret_cast<Upper*>(bytes + uppers_at);
  auto* const lower_nodes = reinterpret_cast<Lower*>(bytes + lowers_at);
  auto* const leaves = reinterpret_cast<Leaf*>(bytes + leaves_at);
  for (const Int3& p : uppers.origins) {
    auto& tile = *reinterpret_cast<Root::Tile*>(bytes + root_at + sizeof(Root) +
                                                root.mTableSize * sizeof(Root::Tile));
    tile.key = Root::CoordToKey(nanovdb::Coord(p.x, p.y, p.z));
    tile.child = static_cast<std::int64_t>(uppers_at + root.mTableSize++ * sizeof(Upper) - root_at);
  }
  const auto link = [](auto& parent, std::uint32_t entry, const void* child) {
    parent.mChildMask.setOn(entry), parent.setChild(entry, child);
  };
  for (std::size_t i = 0; i < lowers.origins.size(); ++i) {
    const Int3& p = lowers.origins[i];
    link(upper_nodes[uppers.number(p)], uppers.entry(p), &lower_nodes[i]);
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    link(lower_nodes[lowers.number(places[i])], lowers.entry(places[i]), &leaves[i]);
  }
  tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
    Leaf& leaf = leaves[i];
    leaf.mFlags = log2_float_bits << 5;
    fill(i, leaf.mValues);
    for (std::uint32_t n = 0; n < leaf_voxels; ++n) leaf.mValueMask.set(n, leaf.mValues[n] != 0);
  });
  return volume;
}

}  // namespace pt
