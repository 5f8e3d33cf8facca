// Clouds made of noise.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "common/scene/load/pbrt/scene_parts.h"

namespace pt::pbrt {
namespace {

/// Perlin's permutation, which is part of his definition.
constexpr std::array<std::uint8_t, 256> permutation = {
    151, 160, 137, 91,  90,  15,  131, 13,  201, 95,  96,  53,  194, 233, 7,   225, 140, 36,  103,
    30,  69,  142, 8,   99,  37,  240, 21,  10,  23,  190, 6,   148, 247, 120, 234, 75,  0,   26,
    197, 62,  94,  252, 219, 203, 117, 35,  11,  32,  57,  177, 33,  88,  237, 149, 56,  87,  174,
    20,  125, 136, 171, 168, 68,  175, 74,  165, 71,  134, 139, 48,  27,  166, 77,  146, 158, 231,
    83,  111, 229, 122, 60,  211, 133, 230, 220, 105, 92,  41,  55,  46,  245, 40,  244, 102, 143,
    54,  65,  25,  63,  161, 1,   216, 80,  73,  209, 76,  132, 187, 208, 89,  18,  169, 200, 196,
    135, 130, 116, 188, 159, 86,  164, 100, 109, 198, 173, 186, 3,   64,  52,  217, 226, 250, 124,
    123, 5,   202, 38,  147, 118, 126, 255, 82,  85,  212, 207, 206, 59,  227, 47,  16,  58,  17,
    182, 189, 28,  42,  223, 183, 170, 213, 119, 248, 152, 2,   44,  154, 163, 70,  221, 153, 101,
    155, 167, 43,  172, 9,   129, 22,  39,  253, 19,  98,  108, 110, 79,  113, 224, 232, 178, 185,
    112, 104, 218, 246, 97,  228, 251, 34,  242, 193, 238, 210, 144, 12,  191, 179, 162, 241, 81,
    51,  145, 235, 249, 14,  239, 107, 49,  192, 214, 31,  181, 199, 106, 157, 184, 84,  204, 176,
    115, 121, 50,  45,  127, 4,   150, 254, 138, 236, 205, 93,  222, 114, 67,  29,  24,  72,  243,
    141, 128, 195, 78,  66,  215, 61,  156, 180};

int permuted(int i) { return permutation[static_cast<std::size_t>(i & 255)]; }

/// The slope at a cell's corner, by four bits of its hash: the sum of two axes with signs.
constexpr std::array<Vec3, 16> slopes = [] {
  constexpr int axes[8][2] = {{0, 1}, {0, 1}, {0, 2}, {0, 2}, {1, 2}, {1, 2}, {0, 1}, {1, 2}};
  std::array<Vec3, 16> all{};
  for (int h = 0; h < 16; ++h) {
    float sum[3] = {};
    sum[axes[h / 2][0]] = h & 1 ? -1.0f : 1.0f;
    sum[axes[h / 2][1]] = h & 2 ? -1.0f : 1.0f;
    all[static_cast<std::size_t>(h)] = {sum[0], sum[1], sum[2]};
  }
  return all;
}();

float slope_at(int hash, const Vec3& way) {
  const Vec3& s = slopes[static_cast<std::size_t>(hash & 15)];
  return s.x * way.x + s.y * way.y + s.z * way.z;
}

/// By differences of this size, as pbrt has it: they are a part of its cloud's shape.
Vec3 noise_gradient(const Vec3& p) {
  constexpr float delta = 0.01f;
  const float here = perlin_noise(p);
  Vec3 gradient;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 beside = p;
    beside[axis] += delta;
    gradient[axis] = (perlin_noise(beside) - here) / delta;
  }
  return gradient;
}

constexpr float octave_ratio = 1.99f;

}  // namespace

float perlin_noise(const Vec3& p) {
  // Farther out there are no numbers but integers.
  if (!(max_abs(p) < 0x1p23f)) return 0.0f;
  glm::ivec3 cell(p);  // faster than floor()
  for (int axis = 0; axis < 3; ++axis) {
    if (p[axis] < static_cast<float>(cell[axis])) --cell[axis];
  }
  const Vec3 offset = p - Vec3(cell);
  const Vec3 fade = offset * offset * offset * (offset * (offset * 6.0f - 15.0f) + 10.0f);
  float planes[2];
  for (int i = 0; i < 2; ++i) {
    const int of_x = permuted(cell.x + i);
    float rows[2];
    for (int j = 0; j < 2; ++j) {
      const int of_xy = permuted(of_x + cell.y + j);
      const Vec3 way = offset - Vec3(i, j, 0);
      const float near = slope_at(permuted(of_xy + cell.z), way);
      const float far = slope_at(permuted(of_xy + cell.z + 1), way - Vec3(0, 0, 1));
      rows[j] = near + fade.z * (far - near);
    }
    planes[i] = rows[0] + fade.y * (rows[1] - rows[0]);
  }
  return planes[0] + fade.x * (planes[1] - planes[0]);
}

float cloud_density(const CloudShape& shape, const Vec3& p) {
  const float ground = 2.0f * std::fmax(0.0f, 0.5f - p.y);
  if (ground >= 1.0f) return 1.0f;  // whatever the noise adds
  Vec3 place = shape.frequency * p;
  if (shape.wispiness > 0.0f) {
    float reach = 0.05f * shape.wispiness, finer = 10.0f;
    for (int octave = 0; octave < 2; ++octave) {
      place += reach * noise_gradient(finer * place);
      reach *= 0.5f, finer *= octave_ratio;
    }
  }
  float noise = 0.0f, amplitude = 0.5f, finer = 1.0f;
  for (int octave = 0; octave < 5; ++octave) {
    noise += amplitude * perlin_noise(finer * place);
    amplitude *= 0.5f, finer *= octave_ratio;
  }
  const float wisps = glm::clamp((1.0f - p.y) * 4.5f * shape.density * noise, 0.0f, 1.0f);
  return glm::clamp(wisps + ground, 0.0f, 1.0f);
}

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
