// Fits a tree to geometry that has moved.
#pragma once

#include <span>

#include "common/accel/build/triangle_tree_data.h"
#include "common/geometry/instance.h"
#include "common/geometry/mesh.h"

namespace pt {

/// The meshes have the triangles with which `tree` was built, and their vertices may have moved;
/// the instances are of the same groups, and their transforms may have changed. Nodes keep their
/// children, so that rays take longer the further triangles part from their neighbours; parts of
/// split triangles get the boxes of whole ones. The tree over instances is built again.
/// Throws Error as build_triangle_tree() does, and for meshes of fewer triangles.
void refit_triangle_tree(TriangleTreeData& tree, std::span<const Mesh> meshes,
                         std::span<const Instance> instances);

}  // namespace pt
