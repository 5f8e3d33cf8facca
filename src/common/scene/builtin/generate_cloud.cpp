#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <atomic>

#include "common/error/error.h"
#include "common/sampling/random.h"
#include "common/scene/builtin/generated_scenes.h"
#include "common/scene/builtin/noise.h"
#include "common/scene/builtin/scene_name.h"
#include "common/scene/builtin/shapes.h"

namespace pt {
namespace {

constexpr std::uint32_t cloud_seed = 7;
constexpr double billow_size = 0.6;  ///< of the first octave's lattice
constexpr double mean_cosine = 0.8;
constexpr double cloud_reach = 1.0;  ///< farther from a cloud's middle there is hardly any of it
constexpr double cloudlet_radii[] = {0.44, 0.26, 0.26, 0.22, 0.22, 0.18, 0.18, 0.18,
                                     0.13, 0.13, 0.13, 0.13, 0.09, 0.09, 0.09, 0.09};

/// A third of the density where that is in [0, 1]: a ball with a flat foot, billowed by noise.
double thickness_at(const glm::dvec3& p, int octaves) {
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
  return 0.55 + 0.85 * billows - from_middle;
}

double density_of(double thickness) { return std::clamp(3 * thickness, 0.0, 1.0); }

/// The same of a sparse grid: of integers, whose sums do not depend on their order.
double densest_column_of_tree(const VolumeData& volume) {
  constexpr double unit = 65536;
  std::vector<std::atomic<std::uint32_t>> sums(std::size_t{volume.size[0]} * volume.size[1]);
  for_each_brick(&volume.nodes[volume.root], [&](const SparseBrick& brick) {
    for (int column = 0; column < 64; ++column) {
      double sum = 0;
      for (int k = 0; k < 8; ++k) sum += static_cast<double>(brick.values[8 * column + k]);
      if (sum == 0) continue;
      const auto x = static_cast<std::size_t>(brick.low.x + column / 8),
                 y = static_cast<std::size_t>(brick.low.y + column % 8);
      sums[x + y * volume.size[0]] += static_cast<std::uint32_t>(sum * unit);
    }
  });
  return *std::ranges::max_element(sums) / unit;
}

/// The largest sum of a column of voxels along z.
double densest_column(const VolumeData& volume) {
  if (volume.is_sparse()) return densest_column_of_tree(volume);
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

/// One of several clouds: in the cube [-1, 1]^3.
struct Cloudlet {
  glm::dvec3 middle;
  double radius;  ///< it has no part farther away
};

/// At random places, where they fade out within the cube; so many that they fill `percent` of it,
/// by an estimate from points: a cloud is as large as a ball of `active` times its radius.
std::vector<Cloudlet> cloudlets_of(std::uint32_t side, float percent) {
  constexpr double active = 0.51;
  constexpr std::size_t most = 4000;
  std::uint32_t draw = 0;
  const auto uniform = [&] {
    return 2 * static_cast<double>(to_unit_float(combine_hash(cloud_seed, draw++))) - 1;
  };
  const auto point = [&] {
    const double x = uniform(), y = uniform(), z = uniform();
    return glm::dvec3(x, y, z);
  };
  std::vector<Cloudlet> all;
  std::vector<glm::dvec3> empty(8192);
  const double wanted_empty = static_cast<double>(empty.size()) * (1 - 0.01 * double{percent});
  while (all.size() < most && (all.empty() || static_cast<double>(empty.size()) > wanted_empty)) {
    const double radius = cloudlet_radii[all.size() % std::size(cloudlet_radii)];
    all.push_back({(1 - 12.0 / side - radius) * point(), radius});
    if (all.size() == 1) std::ranges::generate(empty, point);
    std::erase_if(empty, [&](const glm::dvec3& p) {
      return glm::length(p - all.back().middle) < active * radius;
    });
  }
  return all;
}

/// Thicknesses at the corners of the eight blocks of 4^3 voxels of a brick.
struct BrickLattice {
  static constexpr int spacing = 4, points = 3;
  float values[points][points][points];
  bool is_empty = true;

  BrickLattice() { std::fill_n(&values[0][0][0], points * points * points, -1.0f); }

  /// Adds a cloud's part. `p` is in the first voxel's middle.
  void add(const Cloudlet& cloudlet, const glm::dvec3& p, double voxel) {
    const double scale = cloud_reach / cloudlet.radius, step = spacing * voxel * scale;
    const int octaves = std::min(resolved_octaves(step / billow_size), 6);
    for (int n = 0; n < points * points * points; ++n) {
      const glm::dvec3 q =
          scale * (p - cloudlet.middle) + step * glm::dvec3(n / 9, n / 3 % 3, n % 3);
      // It fades towards the radius, whatever the noise.
      const double fade = 4 * (1 - glm::length(q) / cloud_reach);
      if (!(fade > 0)) continue;
      const double thickness = std::min(thickness_at(q, octaves), fade);
      float& value = values[n / 9][n / 3 % 3][n % 3];
      value = std::max(value, static_cast<float>(thickness));
      is_empty = is_empty && !(thickness > 0);
    }
  }

  float at(int i, int j, int k) const {
    const auto part = [](int n) { return 0.25f * static_cast<float>(n % spacing); };
    const auto along_z = [&](int x, int y) {
      const float* const row = values[x][y] + k / spacing;
      return interpolate(row[0], row[1], part(k));
    };
    const auto along_y = [&](int x) {
      return interpolate(along_z(x, j / spacing), along_z(x, j / spacing + 1), part(j));
    };
    return interpolate(along_y(i / spacing), along_y(i / spacing + 1), part(i));
  }
};

struct CloudBrick {
  glm::ivec3 place;
  BrickLattice lattice;
};

}  // namespace

VolumeData generate_sparse_cloud(std::uint32_t side, float percent) {
  const double voxel = 2.0 / side;
  const auto cloudlets = cloudlets_of(side, percent);
  const std::uint32_t bricks = (side + 7) / 8;
  std::vector<std::vector<CloudBrick>> slabs(bricks);
  tbb::parallel_for(std::uint32_t{0}, bricks, [&](std::uint32_t i) {
    std::vector<Cloudlet> near;
    std::ranges::copy_if(cloudlets, std::back_inserter(near), [&](const Cloudlet& cloudlet) {
      return std::abs((8 * i + 4) * voxel - 1 - cloudlet.middle.x) < cloudlet.radius + 8 * voxel;
    });
    if (near.empty()) return;
    for (std::uint32_t n = 0; n < bricks * bricks; ++n) {
      CloudBrick brick{8 * glm::ivec3(i, n / bricks, n % bricks), {}};
      const glm::dvec3 p = voxel * (glm::dvec3(brick.place) + 0.5) - 1.0;
      for (const Cloudlet& cloudlet : near) {
        const double away = glm::length(p + 3.5 * voxel - cloudlet.middle);
        if (away < cloudlet.radius + 8 * voxel) brick.lattice.add(cloudlet, p, voxel);
      }
      if (!brick.lattice.is_empty) slabs[i].push_back(brick);
    }
  });
  std::vector<glm::ivec3> places;
  std::vector<const BrickLattice*> lattices;
  for (const auto& slab : slabs) {
    for (const auto& brick : slab)
      places.push_back(brick.place), lattices.push_back(&brick.lattice);
  }
  VolumeData volume = make_sparse(side, places, [&](std::size_t brick, float* values) {
    for (int n = 0; n < 512; ++n) {
      const float thickness = lattices[brick]->at(n / 64, n / 8 % 8, n % 8);
      values[n] = static_cast<float>(density_of(static_cast<double>(thickness)));
    }
  });
  volume.to_world = translate(Vec3(-1.0f)) * scale(Vec3(2.0f));
  return volume;
}

bool is_sparse_cloud(std::string_view name) {
  return name.starts_with("cloud:") &&
         (name.ends_with(":sparse") || name.find(":sparse:") != std::string_view::npos);
}

CloudSettings parse_cloud(const SceneName& scene) {
  CloudSettings settings;
  if (scene.parameter.empty()) return settings;
  std::string_view rest = scene.parameter;
  const bool has_depth = rest.find(':') != std::string_view::npos;
  const std::string_view side = next_part(rest);
  settings.is_sparse = is_sparse_cloud(scene.full);
  const std::uint32_t least = settings.is_sparse ? sparse_side_least : 2,
                      most = settings.is_sparse ? sparse_side_most : cloud_side_most;
  if (!read_part(side, least, most, settings.side)) {
    refuse_part(scene, 'N', side, fmt::format("a side from {} to {} voxels", least, most),
                "cloud:N:T:A");
  }
  if (!has_depth) return settings;
  const bool has_albedo = rest.find(':') != std::string_view::npos;
  const std::string_view depth = next_part(rest);
  if (!read_part(depth, 1e-3f, 1e4f, settings.optical_depth)) {
    refuse_part(scene, 'T', depth, "an optical depth from 0.001 to 10000", "cloud:N:T:A");
  }
  if (!has_albedo) return settings;
  const std::string_view albedo = settings.is_sparse ? next_part(rest) : rest;
  const bool has_fill = settings.is_sparse && rest.find(':') != std::string_view::npos;
  if (!read_part(albedo, 0.0f, 1.0f, settings.albedo)) {
    refuse_part(scene, 'A', albedo, "an albedo from 0 to 1", "cloud:N:T:A");
  }
  next_part(rest);  // "sparse"
  if (has_fill && !read_part(rest, 1.0f, 50.0f, settings.percent)) {
    refuse_part(scene, 'P', rest, "a share of the cube from 1 to 50 percent",
                "cloud:N:T:A:sparse:P");
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
        *value++ = static_cast<float>(density_of(thickness_at(p, octaves)));
      }
    }
  });
  return volume;
}

SceneData make_cloud_scene(const CloudSettings& settings, VolumeStorage storage) {
  SceneData scene;
  VolumeData volume = settings.is_sparse ? generate_sparse_cloud(settings.side, settings.percent)
                                         : generate_cloud(settings.side);
  const double densest = densest_column(volume) * 2.0 / settings.side;
  Medium cloud;
  cloud.extinction = Color(static_cast<float>(settings.optical_depth / densest));
  cloud.albedo = Color(settings.albedo);
  cloud.phase = phase_kind_of<HenyeyGreenstein>;
  cloud.phase_parameter = static_cast<float>(mean_cosine);
  if (settings.is_sparse) volume = stored_as(storage, std::move(volume));
  cloud.density_grid = add_grid(scene, std::move(volume));
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
