// Choices that options and physics share: how to sample, and what kernels are compiled for.
#pragma once

#include "common/choices/accel.h"
#include "common/platform/platform.h"

namespace pt {

/// What --path-bytes is a multiple of, and at most.
inline constexpr int path_bytes_step = 16, path_bytes_max = 256;

/// Random numbers of a path, which depend on (seed, pixel, sample, block) alone.
enum class SamplerKind : std::uint8_t { independent, stratified, sobol };

/// How the direction in which a path continues is sampled.
enum class DirectionSampling : std::uint8_t { uniform, cosine, bsdf };

/// How light sampling and direction sampling are combined.
enum class MisHeuristic : std::uint8_t { none, balance, power };

/// How grids that are sparse in their files lie in memory (--volume).
enum class VolumeStorage : std::uint8_t { automatic, dense, sparse };

/// What rays can hit. `mixed`: triangles, instances of triangles, spheres.
enum class Geometry { spheres_and_quads, triangles, mixed };

/// The light sources. `sky`: the environment alone; `emitters`: spheres and quads as well; `full`:
/// lights of all types and an environment, with textures on all surfaces.
enum class Lighting { sky, emitters, full };

/// Properties of a scene that are template arguments of its kernels.
struct SceneTraits {
  Accel accel = Accel::brute;
  Geometry geometry = Geometry::spheres_and_quads;
  Lighting lighting = Lighting::sky;
  bool has_masks = false;
  bool has_media = false;
  bool has_sparse = false;  ///< with has_media: grids may be sparse; CUDA's kernels alone ask
  bool has_motion =
      false;  ///< during the shutter's interval; with neither masks nor media, or both

  constexpr bool operator==(const SceneTraits&) const = default;
  constexpr bool has_lights() const { return lighting != Lighting::sky; }
};

}  // namespace pt
