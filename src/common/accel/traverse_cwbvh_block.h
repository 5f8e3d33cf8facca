// The rays of a block on their ways through the wide tree, which take turns: while one waits for
// its next node from memory the others go on. Each finds what it finds alone
// (traverse_cwbvh_avx2.h), bit for bit.
#pragma once

#include "common/accel/ray_block.h"
#include "common/accel/triangle_query.h"

namespace pt {

/// Of a tree without instances. Without has_avx2() they must not be called.
void closest_triangles_in_turns(const TriangleTree& tree, const RayBlock& rays, HitBlock& hits);
/// A bit for each ray that meets anything.
std::uint32_t any_triangles_in_turns(const TriangleTree& tree, const RayBlock& rays);

}  // namespace pt
