// Grids of media for tests: how to make them, and what they say, in double precision.
#pragma once

#include <array>
#include <functional>

#include "common/medium/sample_grid.h"
#include "common/scene/data/volume_data.h"
#include "common/scene/prepare/prepare_steps.h"
#include "statistics.h"

namespace pt {

using GridSize = std::array<std::uint32_t, 3>;

/// The value of a voxel's channel.
using VoxelValue = std::function<double(const GridSize& voxel, std::uint32_t channel)>;

inline VolumeData make_volume(const GridSize& size, std::uint32_t channels, bool interpolates,
                              const Affine& to_world, const VoxelValue& value) {
  VolumeData volume;
  std::copy(size.begin(), size.end(), volume.size);
  volume.channels = channels, volume.interpolates = interpolates, volume.to_world = to_world;
  for (std::uint32_t k = 0; k < size[2]; ++k) {
    for (std::uint32_t j = 0; j < size[1]; ++j) {
      for (std::uint32_t i = 0; i < size[0]; ++i) {
        for (std::uint32_t c = 0; c < channels; ++c) {
          volume.values.push_back(static_cast<float>(value({i, j, k}, c)));
        }
      }
    }
  }
  return volume;
}

/// Values in [0, 4), a third of them 0.
inline VolumeData random_volume(TestRandom& random, const GridSize& size, std::uint32_t channels,
                                bool interpolates, const Affine& to_world) {
  return make_volume(size, channels, interpolates, to_world, [&](const GridSize&, std::uint32_t) {
    return std::max(random.uniform(-2, 4), 0.0);
  });
}

/// Turned, stretched and moved.
inline Affine random_place(TestRandom& random) {
  const auto part = [&](double lo, double hi) {
    return static_cast<float>(random.uniform(lo, hi));
  };
  const Vec3 sides(part(0.3, 3), part(0.3, 3), part(0.3, 3));
  return translate({part(-2, 2), part(-2, 2), part(-2, 2)}) *
         rotate(Vec3(random.direction()), part(0, 360)) * scale(sides);
}

/// In or near the unit cube at that place, in any direction.
inline Ray random_ray(TestRandom& random, const Affine& to_world) {
  return {to_world.point(Vec3(random.point(0.8) + 0.5)), normalize(Vec3(random.direction()))};
}

/// From z = 0 to `length` the channels' values go linearly from one of n >= 2 voxels to the next,
/// which are value(z, channel); nothing depends on x and y.
inline VolumeData slab_volume(std::uint32_t n, double length, std::uint32_t channels,
                              const std::function<double(double, std::uint32_t)>& value) {
  const double step = length / (n - 1);
  const Affine to_world = translate({-50, -50, static_cast<float>(-0.5 * step)}) *
                          scale({100, 100, static_cast<float>(n * step)});
  return make_volume(
      {1, 1, n}, channels, true, to_world,
      [&](const GridSize& voxel, std::uint32_t c) { return value(voxel[2] * step, c); });
}

/// The same volume by its definition: a sum over all voxels, each of which is a tent (or a box)
/// about its middle; beyond the cube the nearest point of it counts.
class ReferenceVolume {
 public:
  explicit ReferenceVolume(const VolumeData& volume) : v_(volume) {
    glm::dmat3 linear;  // by column
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) linear[j][i] = double{volume.to_world.row[i][j]};
    }
    to_unit_ = glm::inverse(linear);
    place_ = glm::dvec3(volume.to_world.translation());
  }

  glm::dvec3 to_unit(const glm::dvec3& point) const { return to_unit_ * (point - place_); }
  glm::dvec3 to_world(const glm::dvec3& unit) const {
    return glm::inverse(to_unit_) * unit + place_;
  }

  double value(const glm::dvec3& point, std::uint32_t channel) const {
    const glm::dvec3 unit = to_unit(point);
    std::array<std::vector<double>, 3> weights;
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint32_t n = v_.size[axis];
      const double at = std::clamp(unit[axis] * n - 0.5, 0.0, double(n - 1));  // in voxels' middles
      for (std::uint32_t i = 0; i < n; ++i) {
        const double apart = std::abs(at - i);
        weights[axis].push_back(v_.interpolates ? std::max(1 - apart, 0.0) : apart < 0.5);
      }
    }
    double sum = 0;
    const float* values = v_.values.data() + channel % v_.channels;
    for (const double wz : weights[2]) {
      for (const double wy : weights[1]) {
        for (const double wx : weights[0]) {
          sum += wx * wy * wz * double{*values};
          values += v_.channels;
        }
      }
    }
    return sum;
  }

  /// Whether the value jumps within `reach`, in voxels.
  bool is_near_a_jump(const glm::dvec3& point, double reach) const {
    if (v_.interpolates) return false;
    const glm::dvec3 unit = to_unit(point);
    for (int axis = 0; axis < 3; ++axis) {
      const double at = unit[axis] * v_.size[axis], nearest = std::round(at);
      const bool is_wall = nearest >= 1 && nearest <= v_.size[axis] - 1.0;
      if (is_wall && std::abs(at - nearest) < reach) return true;
    }
    return false;
  }

 private:
  VolumeData v_;
  glm::dmat3 to_unit_;
  glm::dvec3 place_;
};

/// What kernels have of a scene's grids.
inline VolumeGrids grids_of(const SceneData& scene) {
  return {scene.grids.data(), scene.grid_values.data(), scene.majorants.data(),
          scene.grid_nodes.data()};
}

/// A scene of one medium, medium 0, whose extinction is multiplied by the volume.
inline SceneData scene_of_density(const VolumeData& density,
                                  const Color& extinction = Color(1.0f)) {
  SceneData scene;
  scene.name = "density";
  Medium medium;
  medium.extinction = extinction;
  medium.density_grid = add_grid(scene, density);
  scene.media.push_back(medium);
  prepare_media(scene);
  return scene;
}

}  // namespace pt
