// The upper level of trees with instances.
#pragma once

#include <span>
#include <vector>

#include "common/accel/build/triangle_tree_data.h"
#include "common/geometry/mesh.h"
#include "common/geometry/motion.h"
#include "common/options/options.h"

namespace pt {

/// Throws Error where an instance's group is 0 or its transform singular.
void check_instances(std::span<const Instance> instances);

/// Group 0 and those of the instances, ascending, each once.
std::vector<std::uint32_t> groups_in_use(std::span<const Instance> instances);

/// The world's box of what lies in `box` in the space of what moves so, while the shutter is open.
Bounds moving_bounds(const Bounds& box, const MotionTracks& motion, const MotionTrack& track);

/// The upper level alone.
struct InstanceTree : TreeNodes<NodesVector> {  ///< the root comes first
  std::vector<InstanceRecord> instances;        ///< in the order of the leaves
};

/// Over the instances of `groups`, which ascend, and group 0 itself if it is among them. Its nodes
/// are numbered from `first_node`. Boxes of instances that move are those of their whole motion.
InstanceTree build_instance_tree(std::span<const GroupTree> groups,
                                 std::span<const Instance> instances, AccelKind accel,
                                 std::uint32_t first_node, const MotionTracks& motion = {});

/// Makes TriangleTreeData::instances of those whose groups are in tree.groups and of group 0 if it
/// is there, and appends the tree over them to the nodes.
void add_instance_tree(TriangleTreeData& tree, std::span<const Instance> instances, AccelKind accel,
                       const MotionTracks& motion = {});

/// Builds the upper level again over instances of the same groups, whose transforms or groups'
/// boxes have changed. A tree without one stays as it is. Throws Error as check_instances().
void rebuild_instance_tree(TriangleTreeData& tree, std::span<const Instance> instances,
                           const MotionTracks& motion = {});

}  // namespace pt
