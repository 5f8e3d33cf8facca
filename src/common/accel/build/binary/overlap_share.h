// What a tree pays for siblings whose boxes share space, which spatial splits may save.
#pragma once

#include "common/accel/build/binary/binary_tree.h"

namespace pt {

/// By the surface area heuristic, the cost of visiting both of two siblings where one would do,
/// relative to the cost of the whole tree. A ray that passes what the boxes of two siblings share
/// visits both; without the other one's overlap it would save the cheaper of them. Summed over all
/// nodes; more than 1 is possible, since what is saved by an ancestor is saved again below. 0 for a
/// leaf. Does not depend on the number of threads.
double overlap_share(const BinaryTree& tree);

}  // namespace pt
