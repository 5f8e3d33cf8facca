// A mountain range of any number of triangles.
#pragma once

#include "common/scene/data/scene_data.h"

namespace pt {

/// Terrain covers 1000 x 1000 units around the origin; heights (y) lie between 0 and 120.
inline constexpr double terrain_extent = 1000.0, terrain_height = 120.0;
inline constexpr std::uint64_t terrain_least = 2, terrain_most = (std::uint64_t{1} << 31) - 1;

/// A ridged multifractal height field over a square grid: 2 n^2 triangles for the largest n with
/// 2 n^2 <= `triangle_count`, row by row from the far left (-x, -z), facing up, without normals.
/// The shape does not depend on the count, but for the finest octaves, which a coarse grid cannot
/// show. The same bits for any number of threads. Throws Error unless 2 <= triangle_count < 2^31.
Mesh generate_terrain(std::uint64_t triangle_count);

/// The terrain in brown under a bright sky without lights. The camera stands above the near left
/// corner and sees terrain in most of its pixels.
SceneData make_terrain_scene(std::uint64_t triangle_count);

}  // namespace pt
