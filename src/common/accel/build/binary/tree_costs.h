// What traversal pays for its steps: one place for the builders of all devices.
#pragma once

#include "common/accel/build/binary/binary_tree.h"
#include "common/accel/cwbvh.h"

namespace pt {

/// Of testing the one or two triangles of a wide tree's leaf, relative to a node's eight boxes.
inline constexpr float cwbvh_triangle_cost = 0.5f;

inline constexpr TreeCosts default_bvh2_costs = {1.0f, 1.0f, 4};
inline constexpr TreeCosts default_cwbvh_costs = {1.0f, cwbvh_triangle_cost, cwbvh_leaf_max};

}  // namespace pt
