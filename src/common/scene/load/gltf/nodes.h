// The hierarchy of nodes: where everything is.
#pragma once

#include <vector>

#include "common/math/transform.h"
#include "common/scene/load/gltf/document/file.h"

namespace pt::gltf {

struct PlacedNode {
  int node = 0;  ///< number in the file
  Affine to_world;
};

/// "nodes[7]"
std::string node_place(int node);

/// All nodes of the default scene, parents before their children, in the order of the file. A node
/// that is its own ancestor or has two parents is placed once, a part of a transformation that
/// cannot be used is left out, and a node that no number can place is lost with its children; each
/// is reported.
std::vector<PlacedNode> place_nodes(File& file);

}  // namespace pt::gltf
