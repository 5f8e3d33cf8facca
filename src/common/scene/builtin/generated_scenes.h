// Scenes that are generated: most of them of any size.
#pragma once

#include "common/scene/builtin/scene_name.h"
#include "common/scene/data/scene_data.h"
#include "common/scene/data/volume_data.h"

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

/// 512 boxes, some on the floor, some in the air, in a room of 20 x 10 x 20 units, all of it times
/// `scale`: 6,158 triangles, two of which are the lamp below the ceiling. Radiances do not depend
/// on the scale, so neither does the image. The room's walls share their corners and have no gap:
/// no ray gets out.
SceneData make_boxes_scene(double scale);

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

inline constexpr std::uint64_t forest_least = 1, forest_most = 100'000'000;

/// Groups 1 to 4: a conifer, a broad tree, a bush and a poplar of 3 to 20 thousand triangles, each
/// a trunk and leaves, about 1 unit tall per unit of scale. They grow around the origin, upwards.
std::vector<Mesh> generate_trees();

/// `count` trees on wavy ground: each is an instance, placed by the R2 sequence (Roberts 2018) over
/// a square whose area grows with their number, turned about its axis, scaled by another factor
/// along each axis and sheared as if bent by wind. An instance depends on its number and on `count`
/// alone. The ground is one mesh of group 0. `percent` of the trees sway while the shutter is open.
/// Throws Error unless 1 <= count <= 100 million.
SceneData make_forest_scene(std::uint64_t count, float percent = 0.0f);

struct ForestSettings {
  std::uint64_t trees = 10'000;
  float percent = 0.0f;  ///< of them that sway
};

/// Reads instances:N:P, of which the last part or both may be left out. Throws Error.
ForestSettings parse_forest(const SceneName& scene);

struct CloudSettings {
  std::uint32_t side = 128;  ///< N: voxels along each axis, from 2 to cloud_side_most
  float optical_depth = 10;  ///< T > 0: of the densest column of voxels along z
  float albedo = 0.999f;     ///< A in [0, 1]
  bool is_sparse = false;    ///< several clouds with much space between them
  float percent = 2.0f;      ///< P: what these fill of the cube
};
inline constexpr std::uint32_t cloud_side_most = 1024;
inline constexpr std::uint32_t sparse_side_least = 64, sparse_side_most = 4096;

/// Whether it is cloud:N:T:A:sparse or :sparse:P.
bool is_sparse_cloud(std::string_view name);

/// Reads cloud:N:T:A or cloud:N:T:A:sparse:P, of which the last parts may be left out. Throws Error
/// that names the part.
CloudSettings parse_cloud(const SceneName& scene);

/// Densities in [0, 1] in the cube [-1, 1]^3; the same bits for any number of threads. The shape
/// does not depend on the side, but for the finest octaves, which a coarse grid cannot show.
VolumeData generate_cloud(std::uint32_t side);

/// Clouds of several sizes in the same cube, of which they fill so many percent, as a sparse grid.
/// The same bits for any number of threads. Throws Error in a program without NanoVDB.
VolumeData generate_sparse_cloud(std::uint32_t side, float percent = 2.0f);

/// The cloud above a ground, under a blue sky and a sun. Its phase function is Henyey and
/// Greenstein's with a mean cosine of 0.8.
SceneData make_cloud_scene(const CloudSettings& settings,
                           VolumeStorage storage = VolumeStorage::automatic);

}  // namespace pt
