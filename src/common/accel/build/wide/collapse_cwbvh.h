// Turns a binary tree of single primitives into the cheapest compressed wide one, by dynamic
// programming.
#pragma once

#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/build/wide/encode_cwbvh.h"
#include "common/accel/nodes.h"

namespace pt {

struct Cwbvh {
  std::vector<CwbvhNode> nodes;      ///< the root first
  std::vector<std::uint32_t> order;  ///< slot -> primitive
};

/// The cheapest of all wide trees whose nodes' and leaves' boxes are those of `tree` (Ylitie et al.
/// 2017, section 3). Leaves have up to min(costs.leaf_max, cwbvh_leaf_max)
/// primitives, each once. The root is a node even where a leaf would do.
Cwbvh collapse_cwbvh(const BinaryTree& tree, const TreeCosts& costs);

struct CollapsedChild {
  std::uint32_t subtree;  ///< a Bvh2Node's child
  bool is_inner;          ///< a wide node of its own; else a leaf of all that is below
  Bounds bounds;
};

struct CollapsedChildren {
  int count = 0;
  CollapsedChild child[cwbvh_width];
};

/// Which subtrees become the children of wide nodes. Ylitie, Karras and Laine 2017, section 3: C(n,
/// i) is the least cost of what is below node n as a forest of at most i wide trees. C(n, 1) is
/// that of a leaf or of a wide node, whose children are the cheapest forest of eight; a forest of i
/// > 1 is one of fewer, or shares i among n's children.
class CollapseChoices {
 public:
  /// Keeps a reference to `tree`, whose root is not a leaf.
  CollapseChoices(const BinaryTree& tree, const TreeCosts& costs);

  /// The children of the wide node that stands for binary node `index`.
  CollapsedChildren children_of(std::uint32_t index) const;
  /// The primitives below, unless there are more than leaf_size_max.
  LeafMembers members_of(std::uint32_t subtree) const;

 private:
  struct Entry {
    float cost[7];          // of a forest of 1..7
    std::uint8_t share[8];  // the first child's share of 2..8 at [i - 1], 0: as a forest of i - 1;
                            // [0]: 1 where a wide node is cheaper than a leaf
  };
  struct Below {
    LeafMembers members;
    float area;
  };

  Below choose(std::uint32_t subtree, float area, int depth);
  void share_out(const Bvh2Node& node, const Below (&half)[2], Entry& entry) const;
  float cost_of(std::uint32_t subtree, float area, int forest) const;
  void gather(std::uint32_t subtree, const Bounds& bounds, int forest,
              CollapsedChildren& children) const;

  const BinaryTree& tree_;
  TreeCosts costs_;
  std::unique_ptr<Entry[]> entries_;  // by binary node
};

}  // namespace pt
