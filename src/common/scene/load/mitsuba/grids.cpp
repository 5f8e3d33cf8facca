// The grids of media become the scene's.
#include <algorithm>
#include <cmath>

#include "common/geometry/primitives.h"
#include "common/scene/load/mitsuba/scene_parts.h"

namespace pt::mitsuba {
namespace {

/// The box around the image of a box.
Bounds image_of(const Affine& map, const Vec3& low, const Vec3& high) {
  Bounds bounds;
  for (int i = 0; i < 8; ++i) {
    bounds.grow(
        map.point({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z}));
  }
  return bounds;
}

/// Around all shapes that have the medium inside; empty where none has.
Bounds room_of(const SceneData& scene, std::uint16_t medium) {
  const auto has_it = [&](std::uint32_t material) {
    const MaterialDescription& m = scene.materials[material];
    return m.is_boundary && m.media.inside == medium;
  };
  Bounds room;
  for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
    if (has_it(scene.sphere_material[i])) room.grow(sphere_bounds(scene.spheres[i]));
  }
  for (std::size_t i = 0; i < scene.quads.size(); ++i) {
    if (has_it(scene.quad_material[i])) room.grow(quad_bounds(scene.quads[i]));
  }
  for (const Mesh& mesh : scene.meshes) {
    if (!has_it(mesh.material)) continue;
    Bounds bounds;
    for (const Vec3& p : mesh.positions) bounds.grow(p);
    if (mesh.group == 0) room.grow(bounds);
    for (const Instance& instance : scene.instances) {
      if (instance.group == mesh.group && !bounds.is_empty()) {
        room.grow(image_of(instance.to_world, bounds.min, bounds.max));
      }
    }
  }
  return room;
}

/// Whether shapes leave the medium room beyond the box around its grid. Without a shape it fills
/// what is outside of all.
bool reaches_beyond(const SceneData& scene, std::uint16_t medium, const VolumeData& density) {
  const Bounds room = room_of(scene, medium);
  if (room.is_empty()) return true;
  const Bounds box = image_of(density.to_world, Vec3(0.0f), Vec3(1.0f));
  const Vec3 tolerance = 1e-3f * (box.max - box.min);  // of shapes around the grid
  return glm::any(glm::lessThan(room.min, box.min - tolerance)) ||
         glm::any(glm::greaterThan(room.max, box.max + tolerance));
}

/// Whether axes of the grid are axes of the world.
bool is_aligned(const Affine& map) {
  for (const Vec4& row : map.row) {
    if ((row.x != 0) + (row.y != 0) + (row.z != 0) != 1) return false;
  }
  return true;
}

Color only_value(const VolumeData& grid) {
  if (grid.channels == 1) return Color(grid.values[0]);
  return {grid.values[0], grid.values[1], grid.values[2]};
}

/// Each grid once, although several media may have it.
class GridsOfScene {
 public:
  explicit GridsOfScene(Context& context) : context_(context) {}

  void add_density(std::uint16_t number, const Context::MediumGrids& grids) {
    const VolumeData& grid = context_.volumes.at(grids.density);
    Medium& medium = context_.scene.media[number];
    expect_finite(*grids.medium, medium, grid);
    if (!grid.is_sparse() && !has_empty_rim(grid.size, grid.channels, grid.values.data()) &&
        reaches_beyond(context_.scene, number, grid)) {
      if (grid.interpolates || !is_aligned(grid.to_world)) {
        context_.warn_once("beyond grid", grids.medium->element(),
                           "a medium reaches beyond its grid, where nothing is: its density fades "
                           "within half a voxel");
      }
      medium.density_grid =
          index_of(padded_, grids.density, [&] { return with_rim_of_zeros(grid); });
    } else if (is_constant(grid)) {
      medium.extinction *= only_value(grid);
    } else {
      medium.density_grid = index_of(plain_, grids.density, [&] { return grid; });
    }
  }

  void add_albedo(std::uint16_t number, const Context::MediumGrids& grids) {
    const VolumeData& of_file = context_.volumes.at(grids.albedo);
    const VolumeData grid = of_file.is_sparse() ? dense_copy(of_file) : of_file;
    Medium& medium = context_.scene.media[number];
    const auto bounded = [&] { return at_most_one(*grids.albedo, grid); };
    if (is_constant(grid)) {
      medium.albedo *= only_value(bounded());
    } else {
      medium.albedo_grid = index_of(albedos_, grids.albedo, bounded);
    }
  }

 private:
  using Indices = std::map<const Object*, std::uint32_t>;

  static bool is_constant(const VolumeData& grid) { return grid.values.size() == grid.channels; }

  template <class Make>
  std::uint32_t index_of(Indices& indices, const Object* name, Make&& make) {
    const auto [entry, is_new] = indices.try_emplace(name, no_grid);
    if (is_new) entry->second = add_grid(context_.scene, make());
    return entry->second;
  }

  static void expect_finite(const Object& object, const Medium& medium, const VolumeData& grid) {
    const float extinction = largest_value(grid) * max_abs(medium.extinction);
    if (!std::isfinite(extinction)) {
      fail(object.element(), "an extinction of {} somewhere; expected a finite one", extinction);
    }
  }

  VolumeData at_most_one(const Object& volume, VolumeData grid) {
    for (float& value : grid.values) {
      if (!(value > 1)) continue;
      value = 1;
      context_.warn_once("albedo above 1", volume.element(),
                         "an albedo above 1: 1 is used, for conservation of energy");
    }
    return grid;
  }

  Context& context_;
  Indices plain_, padded_, albedos_;
};

}  // namespace

void add_grids(Context& context) {
  GridsOfScene grids_of_scene(context);
  for (const auto& [medium, grids] : context.medium_grids) {
    if (grids.density) grids_of_scene.add_density(medium, grids);
    if (grids.albedo) grids_of_scene.add_albedo(medium, grids);
  }
  context.volumes.clear();
}

}  // namespace pt::mitsuba
