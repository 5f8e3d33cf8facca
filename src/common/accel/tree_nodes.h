// The nodes of trees over triangles: the one list of the structures that have some.
#pragma once

#include "common/accel/bvh2.h"
#include "common/accel/cwbvh.h"

namespace pt {

/// Array<Node> of each structure; at most one is filled. For each, function(array) is called, or
/// function(array, array of another tree).
template <template <class> class Array>
struct TreeNodes {
  Array<Bvh2Node> bvh2{};
  Array<CwbvhNode> cwbvh{};

  template <class Function>
  void for_each_nodes(Function&& function) const {
    function(bvh2);
    function(cwbvh);
  }
  template <class Other, class Function>
  void for_each_nodes(Other& other, Function&& function) {
    function(bvh2, other.bvh2);
    function(cwbvh, other.cwbvh);
  }
  template <class Other, class Function>
  void for_each_nodes(Other& other, Function&& function) const {
    function(bvh2, other.bvh2);
    function(cwbvh, other.cwbvh);
  }
};

template <class Node>
using NodesPointer = const Node*;

}  // namespace pt
