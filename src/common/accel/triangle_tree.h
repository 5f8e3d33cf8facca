// What rays are traced against in scenes made of triangles: the triangles, the tree over them and,
// in scenes with instances, a tree of trees.
#pragma once

#include "common/accel/nodes.h"
#include "common/choices/accel.h"
#include "common/geometry/motion.h"
#include "common/geometry/triangle.h"
#include "common/math/transform.h"

namespace pt {

// The structures that have nodes: the one list of them.
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

class EmbreeTree;

/// A group of triangles placed in the world.
struct alignas(16) InstanceRecord {
  Affine to_object;    ///< from world space
  std::uint32_t root;  ///< the group's root among the nodes
  std::uint32_t index;
  std::uint32_t first_slot, slot_count;  ///< the group's triangles
  Bounds bounds;                         ///< in the world, of the whole motion; widened
  MotionTrack track = {};                ///< none: it stands still
};

/// A view, passed to kernels by value. All groups share the arrays; child and slot indices are
/// absolute. With instances, `root` is the root of a tree whose leaves hold instances instead of
/// triangles (indices into `instances`), those of wide trees one each; without, the root of the one
/// tree of triangles.
struct TriangleTree : TreeNodes<NodesPointer> {
  const Triangle* triangles = nullptr;  ///< [slot]
  const InstanceRecord* instances = nullptr;
  std::uint32_t triangle_count = 0;  ///< slots
  std::uint32_t instance_count = 0;  ///< 0: the triangles lie in world space
  std::uint32_t root = 0;
  Accel accel = Accel::brute;          ///< set on the CPU, for code that is compiled for any
  const EmbreeTree* embree = nullptr;  ///< on the CPU, with --accel embree
};

}  // namespace pt
