// A forest of instances.
#pragma once

#include "common/scene/data/scene_data.h"

namespace pt {

inline constexpr std::uint64_t forest_least = 1, forest_most = 100'000'000;

/// Groups 1 to 4: a conifer, a broad tree, a bush and a poplar of 3 to 20 thousand triangles, each
/// a trunk and leaves, about 1 unit tall per unit of scale. They grow around the origin, upwards.
std::vector<Mesh> generate_trees();

/// `count` trees on wavy ground: each is an instance, placed by the R2 sequence (Roberts 2018) over
/// a square whose area grows with their number, turned about its axis, scaled by another factor
/// along each axis and sheared as if bent by wind. An instance depends on its number and on `count`
/// alone. The ground is one mesh of group 0. Throws Error unless 1 <= count <= 100 million.
SceneData make_forest_scene(std::uint64_t count);

}  // namespace pt
