// Clouds made of noise.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "common/scene/load/pbrt/media/cloud_noise.h"
#include "common/scene/load/pbrt/media/medium_kinds.h"
#include "common/scene/load/pbrt/media/sample_box.h"

namespace pt::pbrt {
namespace {

/// Voxels along the longest side: 32 for each cell of the first octave, in which the fourth has 4.
constexpr float voxels_per_cell = 32.0f, most_voxels = 160.0f, least_voxels = 16.0f;

void choose_size(float frequency, SampleBox& box) {
  const Vec3 sides = box.high - box.low;
  const float longest = std::max({sides.x, sides.y, sides.z});
  const float voxels = std::clamp(longest * frequency * voxels_per_cell, least_voxels, most_voxels);
  for (int axis = 0; axis < 3; ++axis) {
    const float count = std::ceil(sides[axis] / longest * voxels);
    box.size[axis] = static_cast<std::uint32_t>(std::max(count, 1.0f));
  }
}

}  // namespace

/// pbrt evaluates the noise where it is asked for; we take it from a grid.
Medium read_cloud(Context& context, const Entity& entity) {
  const Parameters& parameters = entity.parameters;
  CloudShape shape;
  shape.density = read_factor(parameters, "density", 1.0f);
  shape.wispiness = read_factor(parameters, "wispiness", 1.0f);
  shape.frequency = read_factor(parameters, "frequency", 5.0f);
  SampleBox box = read_box(entity);
  choose_size(shape.frequency, box);
  std::vector<float> density(box.voxels());
  tbb::parallel_for(0u, box.size[2], [&](std::uint32_t k) {
    float* next = &density[std::size_t{k} * box.size[1] * box.size[0]];
    for (std::uint32_t j = 0; j < box.size[1]; ++j) {
      for (std::uint32_t i = 0; i < box.size[0]; ++i) {
        *next++ = cloud_density(shape, box.center(i, j, k));
      }
    }
  });
  Medium medium = read_coefficients(context, parameters, 1.0f);
  medium.density_grid = add_grid(context.scene, faded_volume(box, 1, density));
  return medium;
}

}  // namespace pt::pbrt
