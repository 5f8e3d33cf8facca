// Whether spatial splits pay: the overlap that they may save in a tree, and the cost of trial rays
// in the trees with and without them.
#pragma once

#include <span>
#include <vector>

#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/build/build_nodes.h"

namespace pt {

/// By the surface area heuristic, the cost of visiting both of two siblings where one would do,
/// relative to the cost of the whole tree. A ray that passes what the boxes of two siblings share
/// visits both; without the other one's overlap it would save the cheaper of them. Summed over all
/// nodes; more than 1 is possible, since what is saved by an ancestor is saved again below. 0 for a
/// leaf. Does not depend on the number of threads.
double overlap_share(const BinaryTree& tree);

// Trial rays: the surface area heuristic holds only for rays that begin outside and hit nothing.

/// A ray and the distance of its hit, or infinity.
struct TrialRay {
  Ray ray;
  float t;
};

/// Rays among the triangles, the same in each call: the second and third ones of `paths` diffuse
/// paths that begin anywhere in `bounds`, as far as these hit anything. There are fewer paths where
/// their rays cost more than `cost_max` in all (trial_cost()): among coincident triangles each ray
/// visits all nodes. `nodes` is a tree over the triangles, which are given by slot; the root comes
/// first.
std::vector<TrialRay> trial_rays(const BuiltNodes& nodes, std::span<const Triangle> triangles,
                                 const Bounds& bounds, std::uint32_t paths,
                                 double cost_max = infinite_distance);

/// What a ray costs on average, in units of one node's visit: all nodes and leaves whose boxes it
/// enters before its hit, which any order of traversal visits. A leaf counts 1.5: with that the
/// cost explains the rates of the GPU's tracer within 2 % (results/log/2026-11-tree-builders.md).
/// The root comes first.
double trial_cost(const BuiltNodes& nodes, std::span<const TrialRay> rays);

}  // namespace pt
