#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>

#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/build/build_triangle_tree.h"
#include "common/accel/build/instance_tree.h"
#include "common/accel/build/mesh_triangles.h"
#include "common/accel/build/wide/encode_cwbvh.h"
#include "common/error/error.h"

namespace pt {

namespace {

Bounds slot_bounds(const TriangleTreeData& tree, std::uint32_t first, std::uint32_t count) {
  Bounds box;
  for (std::uint32_t i = first; i < first + count; ++i) {
    const Triangle& t = tree.triangles[i];
    box.grow(hit_bounds(t.v0, t.v1, t.v2));
  }
  return box;
}

void update_triangles(TriangleTreeData& tree, std::span<const Mesh> meshes) {
  const MeshTriangles triangles(meshes);
  triangles.check();
  const auto most = std::max_element(tree.triangles.begin(), tree.triangles.end(),
                                     [](const auto& a, const auto& b) { return a.id < b.id; });
  if (most != tree.triangles.end() && most->id >= triangles.count()) {
    throw Error(fmt::format("refit: meshes of {} triangles, expected at least {}",
                            triangles.count(), most->id + 1));
  }
  tbb::parallel_for(std::size_t{0}, tree.triangles.size(),
                    [&](std::size_t i) { tree.triangles[i] = triangles[tree.triangles[i].id]; });
}

void update_group_bounds(const TriangleTreeData& tree, GroupTree& group) {
  group.bounds = tbb::parallel_reduce(
      tbb::blocked_range<std::uint32_t>(0, group.slot_count, 4096), Bounds(),
      [&](const auto& part, Bounds box) {
        box.grow(slot_bounds(tree, group.first_slot + part.begin(),
                             static_cast<std::uint32_t>(part.size())));
        return box;
      },
      [](Bounds a, const Bounds& b) {
        a.grow(b);
        return a;
      });
}

// Nodes come before those below: leaves in parallel, then from the last node to the first.
void refit_bvh2(TriangleTreeData& tree, const GroupTree& group) {
  const auto is_reachable = [](const Bvh2Node& node, int i) {
    return child_bounds(node, i).min != unreachable_bounds().min;
  };
  const std::uint32_t end = group.first_node + group.node_count;
  tbb::parallel_for(group.first_node, end, [&](std::uint32_t n) {
    Bvh2Node& node = tree.bvh2[n];
    for (int i = 0; i < 2; ++i) {
      const std::uint32_t child = node.child[i];
      if (!is_leaf(child) || !is_reachable(node, i)) continue;
      set_child_bounds(node, i, slot_bounds(tree, leaf_first(child), leaf_count(child)));
    }
  });
  for (std::uint32_t n = end; n-- > group.first_node;) {
    Bvh2Node& node = tree.bvh2[n];
    for (int i = 0; i < 2; ++i) {
      if (is_leaf(node.child[i])) continue;
      Bounds box = child_bounds(tree.bvh2[node.child[i]], 0);
      box.grow(child_bounds(tree.bvh2[node.child[i]], 1));
      set_child_bounds(node, i, box);
    }
  }
}

// Encodes the node again: the same children in the same slots.
CwbvhNode encode_again(const TriangleTreeData& tree, const CwbvhNode& node,
                       std::span<const Bounds> bounds, std::uint32_t first_node) {
  CwbvhChildren children;
  CwbvhSlots slots;
  std::fill(std::begin(slots.child), std::end(slots.child), no_cwbvh_child);
  for_each_cwbvh_child(node, [&](int s, const CwbvhChild& child) {
    const int c = children.count++;
    slots.child[s] = static_cast<std::uint8_t>(c);
    children.triangles[c] = child.count;
    children.bounds[c] = child.count == 0 ? bounds[child.index - first_node]
                                          : slot_bounds(tree, child.index, child.count);
  });
  return encode_cwbvh_node(children, slots, node.child_base, node.triangle_base);
}

void refit_cwbvh(TriangleTreeData& tree, const GroupTree& group) {
  const std::span<CwbvhNode> nodes(tree.cwbvh.data() + group.first_node, group.node_count);
  std::vector<Bounds> bounds(nodes.size());
  tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t n) {
    for_each_cwbvh_child(nodes[n], [&](int, const CwbvhChild& child) {
      if (child.count > 0) bounds[n].grow(slot_bounds(tree, child.index, child.count));
    });
  });
  for (std::size_t n = nodes.size(); n-- > 0;) {
    for_each_cwbvh_child(nodes[n], [&](int, const CwbvhChild& child) {
      if (child.count == 0) bounds[n].grow(bounds[child.index - group.first_node]);
    });
  }
  tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t n) {
    nodes[n] = encode_again(tree, nodes[n], bounds, group.first_node);
  });
}

}  // namespace

void refit_triangle_tree(TriangleTreeData& tree, std::span<const Mesh> meshes,
                         std::span<const Instance> instances) {
  check_instances(instances);
  update_triangles(tree, meshes);
  for (GroupTree& group : tree.groups) {
    update_group_bounds(tree, group);
    if (!tree.bvh2.empty()) refit_bvh2(tree, group);
    if (!tree.cwbvh.empty()) refit_cwbvh(tree, group);
  }
  rebuild_instance_tree(tree, instances);
}

}  // namespace pt
