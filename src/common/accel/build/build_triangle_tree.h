// Builds what rays are traced against in scenes made of triangles, on the CPU, and fits it to
// geometry that has moved.
#pragma once

#include <span>

#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/build/binary/build_binary.h"
#include "common/accel/build/triangle_tree_data.h"
#include "common/geometry/mesh.h"
#include "common/geometry/motion.h"
#include "common/options/options.h"

namespace pt {

struct TreeOptions {
  AccelKind accel = AccelKind::cwbvh;       ///< automatic: cwbvh
  TreeBuilder builder = TreeBuilder::best;  ///< one of the CPU's; automatic: best
  SbvhOptions sbvh;
  TreeCosts bvh2_costs = default_bvh2_costs;
  TreeCosts cwbvh_costs = default_cwbvh_costs;

  const TreeCosts& costs() const { return accel == AccelKind::bvh2 ? bvh2_costs : cwbvh_costs; }
};

/// Throws Error for vertices that are not finite, indices that name no vertex, and instances of
/// group 0 or with a singular transform.
void check_geometry(std::span<const Mesh> meshes, std::span<const Instance> instances);

/// Triangles are numbered through the meshes in their order, those of groups included. Without
/// instances the tree is over the meshes of group 0; with instances it is one of two levels, with a
/// tree for each group that is used and one over the instances, the meshes of group 0 being an
/// instance too (see TriangleTreeData::instances). With AccelKind::brute there are no nodes, and
/// slots are in the order of the triangles' numbers.
/// `best` takes, group by group, the tree by sah, after reinsert_nodes() where that helps
/// ("sah-reinsert"); or, where overlap_share() promises something and rays are found to cost less
/// (try_splits.h), the one by sbvh. The time of each builder grows with the triangles' number times
/// its logarithm at most, wherever they lie.
/// Instances that move are within boxes of their whole motion.
/// Throws Error as check_geometry, and for builders that are not the CPU's.
TriangleTreeData build_triangle_tree(std::span<const Mesh> meshes,
                                     std::span<const Instance> instances,
                                     const TreeOptions& options, const MotionTracks& motion = {});

/// Whether trees are built on the CUDA device.
inline bool is_device_builder(TreeBuilder builder) {
  return builder == TreeBuilder::lbvh || builder == TreeBuilder::hploc ||
         builder == TreeBuilder::hploc_reinsert;
}

/// Throws Error where a builder of the device is to work on the CPU, or for a structure that is not
/// a tree of ours. `accel` is the structure in use, never automatic.
void check_builder(TreeBuilder builder, AccelKind accel, bool on_cuda);

/// Fits a tree to geometry that has moved. The meshes have the triangles with which `tree` was
/// built, and their vertices may have moved; the instances are of the same groups, and their
/// transforms may have changed. Nodes keep their children, so that rays take longer the further
/// triangles move away from their neighbours; parts of split triangles get the boxes of whole ones.
/// The tree over instances is built again. Throws Error as build_triangle_tree() does, and for
/// meshes of fewer triangles.
void refit_triangle_tree(TriangleTreeData& tree, std::span<const Mesh> meshes,
                         std::span<const Instance> instances);

}  // namespace pt
