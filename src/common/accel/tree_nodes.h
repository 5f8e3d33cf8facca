// The nodes of trees over triangles: the one list of the structures that have some.
#pragma once

#include "common/accel/cwbvh.h"
#include "common/accel/nodes.h"

namespace pt {

#define PT_TREE_NODES(NODES) \
  NODES(bvh2, Bvh2Node)      \
  NODES(cwbvh, CwbvhNode)

#define PT_TREE_NODES_MEMBER(name, Node) Array<Node> name{};
#define PT_TREE_NODES_CALL(name, Node) function(name);
#define PT_TREE_NODES_CALL_WITH(name, Node) function(name, other.name);

/// Array<Node> of each structure; at most one is filled. for_each_nodes calls function(array) for
/// each, or function(array, that of another tree).
template <template <class> class Array>
struct TreeNodes {
  PT_TREE_NODES(PT_TREE_NODES_MEMBER)

  template <class Function>
  void for_each_nodes(Function&& function) const {
    PT_TREE_NODES(PT_TREE_NODES_CALL)
  }
  template <class Other, class Function>
  void for_each_nodes(Other& other, Function&& function) {
    PT_TREE_NODES(PT_TREE_NODES_CALL_WITH)
  }
  template <class Other, class Function>
  void for_each_nodes(Other& other, Function&& function) const {
    PT_TREE_NODES(PT_TREE_NODES_CALL_WITH)
  }
};

#undef PT_TREE_NODES_MEMBER
#undef PT_TREE_NODES_CALL
#undef PT_TREE_NODES_CALL_WITH

template <class Node>
using NodesPointer = const Node*;

}  // namespace pt
