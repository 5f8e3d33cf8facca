#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "common/error/error.h"
#include "common/scene/builtin/generated_scenes.h"
#include "common/scene/builtin/noise.h"
#include "common/scene/builtin/scene_name.h"
#include "common/scene/builtin/shapes.h"

namespace pt {
namespace {

constexpr std::uint32_t cloud_seed = 7;
constexpr double billow_size = 0.6;  ///< of the first octave's lattice
constexpr double mean_cosine = 0.8;

/// In [0, 1]: a ball with a flat foot, billowed by noise.
double density_at(const glm::dvec3& p, int octaves) {
  const double flattened = p.y < -0.25 ? 2.2 * (p.y + 0.25) - 0.25 : p.y;
  const double from_middle = std::sqrt(p.x * p.x + 1.4 * flattened * flattened + p.z * p.z) / 0.78;
  double billows = 0, amplitude = 1;
  glm::dvec3 q = p / billow_size;
  for (int octave = 0; octave < octaves; ++octave) {
    billows +=
        amplitude * std::abs(gradient_noise<3>(q, cloud_seed + static_cast<std::uint32_t>(octave)));
    amplitude *= 0.55;
    q *= lacunarity;
  }
  return std::clamp(3 * (0.55 + 0.85 * billows - from_middle), 0.0, 1.0);
}

/// The largest sum of a column of voxels along z.
double densest_column(const VolumeData& volume) {
  const std::size_t side = volume.size[0];
  double most = 0;
  for (std::size_t column = 0; column < side * side; ++column) {
    double sum = 0;
    for (std::size_t k = 0; k < side; ++k) {
      sum += static_cast<double>(volume.values[column + side * side * k]);
    }
    most = std::max(most, sum);
  }
  return most;
}

}  // namespace

CloudSettings parse_cloud(const SceneName& scene) {
  CloudSettings settings;
  if (scene.parameter.empty()) return settings;
  std::string_view rest = scene.parameter;
  const bool has_depth = rest.find(':') != std::string_view::npos;
  const std::string_view side = next_part(rest);
  if (!read_part(side, 2u, cloud_side_most, settings.side)) {
    refuse_part(scene, 'N', side, fmt::format("a side from 2 to {} voxels", cloud_side_most),
                "cloud:N:T:A");
  }
  if (!has_depth) return settings;
  const bool has_albedo = rest.find(':') != std::string_view::npos;
  const std::string_view depth = next_part(rest);
  if (!read_part(depth, 1e-3f, 1e4f, settings.optical_depth)) {
    refuse_part(scene, 'T', depth, "an optical depth from 0.001 to 10000", "cloud:N:T:A");
  }
  if (!has_albedo) return settings;
  if (!read_part(rest, 0.0f, 1.0f, settings.albedo)) {
    refuse_part(scene, 'A', rest, "an albedo from 0 to 1", "cloud:N:T:A");
  }
  return settings;
}

VolumeData generate_cloud(std::uint32_t side) {
  VolumeData volume;
  std::fill(std::begin(volume.size), std::end(volume.size), side);
  volume.values.resize(std::size_t{side} * side * side);
  volume.to_world = translate(Vec3(-1.0f)) * scale(Vec3(2.0f));
  const double voxel = 2.0 / side;
  const int octaves = std::min(resolved_octaves(voxel / billow_size), 6);
  tbb::parallel_for(std::uint32_t{0}, side, [&](std::uint32_t k) {
    float* value = &volume.values[std::size_t{k} * side * side];
    for (std::uint32_t j = 0; j < side; ++j) {
      for (std::uint32_t i = 0; i < side; ++i) {
        const glm::dvec3 p((i + 0.5) * voxel - 1, (j + 0.5) * voxel - 1, (k + 0.5) * voxel - 1);
        *value++ = static_cast<float>(density_at(p, octaves));
      }
    }
  });
  return volume;
}

SceneData make_cloud_scene(const CloudSettings& settings) {
  SceneData scene;
  const VolumeData volume = generate_cloud(settings.side);
  const double densest = densest_column(volume) * 2.0 / settings.side;
  Medium cloud;
  cloud.extinction = Color(static_cast<float>(settings.optical_depth / densest));
  cloud.albedo = Color(settings.albedo);
  cloud.phase = phase_kind_of<HenyeyGreenstein>;
  cloud.phase_parameter = static_cast<float>(mean_cosine);
  cloud.density_grid = add_grid(scene, volume);
  scene.media.push_back(cloud);
  MaterialDescription boundary;
  boundary.is_boundary = boundary.passes = true;
  boundary.media = {no_medium, 0};
  add_quad_box(scene, Vec3(0.0f), Vec3(2.0f), 0.0f, scene.add_material(boundary));
  const auto ground = scene.add_material(make_diffuse({0.25f, 0.28f, 0.2f}));
  scene.add_quad({-40, -1.5f, -40}, {0, 0, 80}, {80, 0, 0}, ground);
  scene.sky = {{0.4f, 0.5f, 0.65f}, {0.1f, 0.2f, 0.5f}};
  DeltaLight sun;
  sun.kind = LightKind::directional;
  sun.direction = normalize(Vec3(-0.6f, -1.0f, -0.35f));
  sun.intensity = {2.6f, 2.45f, 2.2f};
  scene.delta_lights.push_back(sun);
  scene.camera = {{0, 0.25f, 4.2f}, {0, 0.05f, 0}, {0, 1, 0}, 32.0f, 0.0f, 4.2f};
  return scene;
}

}  // namespace pt
