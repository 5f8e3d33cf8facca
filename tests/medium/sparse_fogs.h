// Fogs of NanoVDB's files, dense or sparse, for comparisons of both.
#pragma once

#include "cloud_modes.h"
#include "common/scene/load/files/volumes/volume_files.h"
#include "load/nanovdb_bytes.h"
#include "medium/filled_glasses.h"

namespace pt {

/// Files whose leaves differ, and one with tiles.
inline const std::vector<std::string> fog_files{"balls.nvdb",     "balls_fp4.nvdb",
                                                "balls_fp8.nvdb", "balls_fp16.nvdb",
                                                "balls_fpn.nvdb", "tile.nvdb"};

/// Around the middle of the files' balls, of this size, to `place`.
inline Affine fog_to(const Vec3& place) {
  return translate(place) * scale(Vec3(0.35f)) * translate({-3.5f, -4.125f, -5});
}

/// Boxes of fogs beside each other; one of them glows in colours.
inline SceneData sparse_fogs(VolumeStorage storage) {
  SceneData scene;
  scene.name = "sparse fogs";
  for (std::size_t i = 0; i < fog_files.size(); ++i) {
    Medium medium = make_medium({9, 5, 14}, {0.9f, 0.8f, 0.6f});
    const Vec3 place(-1.5f + 1.5f * static_cast<float>(i % 3), i < 3 ? 0.9f : -0.4f, 0);
    VolumeData density = read_nanovdb(nanovdb_path(fog_files[i]), {}, storage);
    density.to_world = fog_to(place) * density.to_world;
    density.interpolates = i != 1;
    medium.density_grid = add_grid(scene, std::move(density));
    scene.media.push_back(medium);
    add_cuboid(scene, place - 0.55f, place + 0.55f,
               scene.add_material(make_boundary(no_medium, static_cast<std::uint32_t>(i))));
  }
  VolumeData glow = read_nanovdb(nanovdb_path("two.nvdb"), "temperature", storage);
  std::vector<float> values;
  EXPECT_EQ(glow.is_sparse(), glow.is_sparse() && number_voxels(glow, values));
  std::vector<float> colors;
  for (const float value : glow.is_sparse() ? values : glow.values) {
    colors.insert(colors.end(), {value, 0.5f * value * value, 0.01f});
  }
  glow.channels = 3;
  (glow.is_sparse() ? glow.colors : glow.values) = colors;
  glow.to_world = fog_to({-1.5f, 0.9f, 0}) * glow.to_world;
  scene.media[0].emission = Color(2.0f);
  scene.media[0].emission_grid = add_grid(scene, std::move(glow));
  add_floor_and_lights(scene);
  scene.sky = {Color(0.2f), {0.5f, 0.6f, 0.9f}};
  scene.camera = {{0.3f, 0.8f, 4.8f}, {0, 0.2f, 0}, {0, 1, 0}, 45.0f, 0.0f, 4.0f};
  return scene;
}

/// Glasses of triangles, one of them filled with a fog: boundaries that all have a BSDF, among
/// media with dense grids.
inline SceneData sparse_glasses(VolumeStorage storage) {
  SceneData scene = filled_glasses();
  scene.name = "sparse glasses";
  VolumeData density = read_nanovdb(nanovdb_path("balls_fp8.nvdb"), {}, storage);
  density.to_world = fog_to({-1.2f, 0, 0}) * density.to_world;
  scene.media[0].density_grid = add_grid(scene, std::move(density));
  scene.media[0].extinction = Color(6, 4, 12);
  return scene;
}

}  // namespace pt
