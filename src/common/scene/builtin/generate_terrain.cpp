#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "common/error/error.h"
#include "common/scene/builtin/generated_scenes.h"
#include "common/scene/builtin/noise.h"

namespace pt {
namespace {

constexpr double mountain_size = 260.0;  ///< of the first octave's lattice
constexpr std::uint32_t terrain_seed = 1;

/// The largest n with 2 n^2 <= triangle_count.
std::uint64_t grid_size(std::uint64_t triangle_count) {
  auto n = static_cast<std::uint64_t>(std::sqrt(static_cast<double>(triangle_count) / 2));
  while (2 * n * n > triangle_count) --n;
  while (2 * (n + 1) * (n + 1) <= triangle_count) ++n;
  return n;
}

}  // namespace

Mesh generate_terrain(std::uint64_t triangle_count) {
  if (triangle_count < terrain_least || triangle_count > terrain_most) {
    throw Error(fmt::format("terrain of {} triangles: expected from {} to {}", triangle_count,
                            terrain_least, terrain_most));
  }
  const std::uint64_t n = grid_size(triangle_count);
  const double spacing = terrain_extent / static_cast<double>(n);
  const int octaves = resolved_octaves(spacing / mountain_size);
  const auto coordinate = [&](std::uint64_t i) {
    return spacing * static_cast<double>(i) - 0.5 * terrain_extent;
  };
  Mesh mesh;
  mesh.positions.resize((n + 1) * (n + 1));
  tbb::parallel_for(std::uint64_t{0}, n + 1, [&](std::uint64_t row) {
    for (std::uint64_t i = 0; i <= n; ++i) {
      const double x = coordinate(i), z = coordinate(row);
      const double height =
          0.5 * terrain_height *
          ridged_multifractal<2>({x / mountain_size, z / mountain_size}, octaves, terrain_seed);
      mesh.positions[row * (n + 1) + i] = {static_cast<float>(x), static_cast<float>(height),
                                           static_cast<float>(z)};
    }
  });
  mesh.triangles.resize(2 * n * n);
  tbb::parallel_for(std::uint64_t{0}, n, [&](std::uint64_t row) {
    for (std::uint64_t i = 0; i < n; ++i) {
      const auto far = static_cast<std::uint32_t>(row * (n + 1) + i);
      const auto near = static_cast<std::uint32_t>(far + n + 1);
      mesh.triangles[2 * (row * n + i)] = {{far, near, far + 1}};
      mesh.triangles[2 * (row * n + i) + 1] = {{far + 1, near, near + 1}};
    }
  });
  return mesh;
}

SceneData make_terrain_scene(std::uint64_t triangle_count) {
  SceneData scene;
  scene.meshes.push_back(generate_terrain(triangle_count));
  scene.meshes.back().material = scene.add_material(make_diffuse({0.45f, 0.38f, 0.30f}));
  scene.sky = {{0.05f, 0.08f, 0.12f}, {1.25f, 1.4f, 1.6f}};  // overcast: brightest above
  scene.camera = {{-490, 175, 490}, {0, 10, 0}, {0, 1, 0}, 38.0f, 0.0f, 500.0f};
  return scene;
}

}  // namespace pt
