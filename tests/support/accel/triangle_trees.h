// Trees over triangles for the tests of their traversal: made in the simplest way that is right,
// and independent of the builders that the program uses.
#pragma once

#include <vector>

#include "common/accel/build/binary/build_bvh2.h"
#include "common/accel/build/wide/encode_cwbvh.h"
#include "common/accel/triangle_tree.h"

namespace pt {

/// Collapses a binary tree, opening the largest child until a node has eight.
class SimpleCollapse {
 public:
  /// `bounds[slot]` of what the leaves hold. Appends to `nodes`; the new root's place is returned.
  SimpleCollapse(const std::vector<Bvh2Node>& binary, const std::vector<Bounds>& bounds,
                 std::uint32_t leaf_max, std::vector<CwbvhNode>& nodes,
                 std::vector<std::uint32_t>& order)
      : binary_(binary), bounds_(bounds), leaf_max_(leaf_max), nodes_(nodes), order_(order) {}

  /// `order` gets the slots of the binary tree in the order of the wide tree's.
  std::uint32_t collapse(std::uint32_t root) {
    const auto place = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    fill(place, open(root));
    return place;
  }

 private:
  struct Child {
    Bounds bounds;
    std::uint32_t code;  ///< as in Bvh2Node
  };

  std::vector<Child> open(std::uint32_t code) const {
    if (!is_leaf(code)) {
      const Bvh2Node& n = binary_[code];
      return {{{{n.xy[0].x, n.xy[0].z, n.z.x}, {n.xy[0].y, n.xy[0].w, n.z.y}}, n.child[0]},
              {{{n.xy[1].x, n.xy[1].z, n.z.z}, {n.xy[1].y, n.xy[1].w, n.z.w}}, n.child[1]}};
    }
    const std::uint32_t first = leaf_first(code), count = leaf_count(code), half = count / 2;
    return {leaf(first, half), leaf(first + half, count - half)};
  }

  Child leaf(std::uint32_t first, std::uint32_t count) const {
    Child child{{}, make_leaf(first, count)};
    for (std::uint32_t i = 0; i < count; ++i) child.bounds.grow(bounds_[first + i]);
    return child;
  }

  bool may_open(std::uint32_t code) const { return !is_leaf(code) || leaf_count(code) > leaf_max_; }

  void fill(std::uint32_t place, std::vector<Child> children) {
    while (children.size() < 8) {
      int largest = -1;
      for (int i = 0; i < static_cast<int>(children.size()); ++i) {
        if (may_open(children[i].code) &&
            (largest < 0 ||
             children[i].bounds.half_area() > children[largest].bounds.half_area())) {
          largest = i;
        }
      }
      if (largest < 0) break;
      const std::vector<Child> two = open(children[largest].code);
      children[largest] = two[0];
      children.push_back(two[1]);
    }
    encode(place, children);
  }

  void encode(std::uint32_t place, const std::vector<Child>& children) {
    CwbvhChildren wide;
    wide.count = static_cast<int>(children.size());
    for (int i = 0; i < wide.count; ++i) {
      wide.bounds[i] = children[i].bounds;
      wide.triangles[i] = may_open(children[i].code) ? 0 : leaf_count(children[i].code);
    }
    const CwbvhSlots slots = assign_cwbvh_slots(wide);
    const auto child_base = static_cast<std::uint32_t>(nodes_.size());
    nodes_[place] =
        encode_cwbvh_node(wide, slots, child_base, static_cast<std::uint32_t>(order_.size()));
    std::vector<std::uint32_t> inner;
    for (const std::uint8_t c : slots.child) {
      if (c == no_cwbvh_child) continue;
      for (std::uint32_t i = 0; i < wide.triangles[c]; ++i)
        order_.push_back(leaf_first(children[c].code) + i);
      if (wide.triangles[c] == 0) inner.push_back(children[c].code);
    }
    nodes_.resize(nodes_.size() + inner.size());
    for (std::size_t i = 0; i < inner.size(); ++i) {
      fill(child_base + static_cast<std::uint32_t>(i), open(inner[i]));
    }
  }

  const std::vector<Bvh2Node>& binary_;
  const std::vector<Bounds>& bounds_;
  std::uint32_t leaf_max_;
  std::vector<CwbvhNode>& nodes_;
  std::vector<std::uint32_t>& order_;
};

/// A group of triangles, or the instances of groups, with both kinds of tree. Their slots are
/// ordered differently.
struct TestTrees {
  std::vector<Triangle> binary_triangles, wide_triangles;
  std::vector<Bvh2Node> binary_nodes;
  std::vector<CwbvhNode> wide_nodes;
  std::vector<InstanceRecord> binary_instances, wide_instances;
  std::uint32_t binary_root = 0, wide_root = 0;

  TriangleTree binary() const {
    TriangleTree tree;
    tree.bvh2 = binary_nodes.data();
    tree.triangles = binary_triangles.data();
    tree.instances = binary_instances.data();
    tree.triangle_count = static_cast<std::uint32_t>(binary_triangles.size());
    tree.instance_count = static_cast<std::uint32_t>(binary_instances.size());
    tree.root = binary_root;
    return tree;
  }
  TriangleTree wide() const {
    TriangleTree tree = binary();
    tree.bvh2 = nullptr;
    tree.cwbvh = wide_nodes.data();
    tree.triangles = wide_triangles.data();
    tree.instances = wide_instances.data();
    tree.root = wide_root;
    return tree;
  }

  /// Adds trees over things with these bounds. The slots of things are returned in the order of
  /// both trees.
  struct Order {
    std::vector<std::uint32_t> binary, wide;
    std::uint32_t binary_root, wide_root;
  };
  Order add(const std::vector<Bounds>& bounds, std::uint32_t wide_leaf_max,
            std::size_t first_binary, std::size_t first_wide) {
    Bvh2 bvh = build_bvh2(bounds, static_cast<std::uint32_t>(bounds.size()), 0.0f);
    std::vector<Bounds> sorted;
    for (const std::uint32_t i : bvh.order) sorted.push_back(bounds[i]);
    Order order;
    std::vector<CwbvhNode> wide;
    SimpleCollapse(bvh.nodes, sorted, wide_leaf_max, wide, order.wide).collapse(0);
    for (std::uint32_t& i : order.wide) i = bvh.order[i];
    order.binary = bvh.order;
    order.binary_root = static_cast<std::uint32_t>(binary_nodes.size());
    order.wide_root = static_cast<std::uint32_t>(wide_nodes.size());
    for (Bvh2Node node : bvh.nodes) {
      for (std::uint32_t& child : node.child) {
        child += is_leaf(child) ? static_cast<std::uint32_t>(first_binary) : order.binary_root;
      }
      binary_nodes.push_back(node);
    }
    for (CwbvhNode node : wide) {
      node.child_base += order.wide_root;
      node.triangle_base += static_cast<std::uint32_t>(first_wide);
      wide_nodes.push_back(node);
    }
    return order;
  }

  /// Adds a group of triangles.
  Order add_triangles(const std::vector<Triangle>& triangles) {
    std::vector<Bounds> bounds;
    for (const Triangle& t : triangles) bounds.push_back(triangle_bounds(t.v0, t.v1, t.v2));
    const Order order = add(bounds, cwbvh_leaf_max, binary_triangles.size(), wide_triangles.size());
    for (const std::uint32_t i : order.binary) binary_triangles.push_back(triangles[i]);
    for (const std::uint32_t i : order.wide) wide_triangles.push_back(triangles[i]);
    binary_root = order.binary_root;
    wide_root = order.wide_root;
    return order;
  }
};

}  // namespace pt
