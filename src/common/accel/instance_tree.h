// The upper level of trees with instances.
#pragma once

#include <span>

#include "common/accel/triangle_tree_data.h"
#include "common/geometry/instance.h"
#include "common/render/options.h"

namespace pt {

/// Throws Error where an instance's group is 0 or its transform singular.
void check_instances(std::span<const Instance> instances);

/// Makes TriangleTreeData::instances of those whose groups are in tree.groups and of group 0 if it
/// is there, and appends the tree over them to the nodes.
void add_instance_tree(TriangleTreeData& tree, std::span<const Instance> instances,
                       AccelKind accel);

}  // namespace pt
