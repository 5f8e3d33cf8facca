// A finely carved object on a floor: the scene of the speed targets.
#pragma once

#include "common/scene/data/scene_data.h"

namespace pt {

inline constexpr std::uint64_t statue_least = 100, statue_most = (std::uint64_t{1} << 31) - 5;

/// A torus knot whose surface is carved by ridged noise, without normals: a closed grid of
/// 2 `around` `along` triangles, around = floor(sqrt(triangle_count / 24)), at least 3, and along =
/// floor(triangle_count / (2 around)): fewer than `triangle_count` by less than 2 around. It fits
/// into a sphere of radius 1 around the origin. The same bits for any number of threads. Throws
/// Error unless triangle_count lies between statue_least and statue_most.
Mesh generate_knot(std::uint64_t triangle_count);

/// The knot, white and diffuse, above a floor of two triangles, with a rectangular lamp of two
/// triangles and a constant sky. `triangle_count` is the knot's.
SceneData make_statue_scene(std::uint64_t triangle_count);

}  // namespace pt
