// What a tree pays for siblings whose boxes share space, and whether spatial splits may save it.
#pragma once

#include "common/accel/build/binary_tree.h"

namespace pt {

/// By the surface area heuristic, the cost of visiting both of two siblings where one would do,
/// relative to the cost of the whole tree. A ray that passes what the boxes of two siblings share
/// visits both; without the other one's overlap it would save the cheaper of them. Summed over all
/// nodes; more than 1 is possible, since what is saved by an ancestor is saved again below. 0 for a
/// leaf. Does not depend on the number of threads.
double overlap_share(const BinaryTree& tree);

/// Whether a tree with spatial splits is worth building and comparing with `tree`, a tree of the
/// same `count` triangles without. Such a tree takes two to six times as long to build, so large
/// scenes need a better prospect.
bool spatial_splits_may_pay(const BinaryTree& tree, std::uint32_t count);

/// What has spatial splits is taken where its cost is at most this part of the other's: rooms whose
/// cost they improve by 1 or 2 % become slower (docs/tracing.md).
inline constexpr double spatial_split_gain = 0.96;

}  // namespace pt
