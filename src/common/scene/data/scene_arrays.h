// The arrays of a scene: the one list of them, for the host's view and for the device's copy.
#pragma once

#include "common/scene/data/scene_data.h"

namespace pt {

/// Calls function(pointer in `view`, vector in `scene`, kind of memory) for every array but those
/// of the tree over triangles, which a device may have built (TriangleTreeData lists them). The
/// kind is a name in statistics.
template <class Function>
void for_each_array(const SceneData& scene, Scene& view, Function&& function) {
  function(view.primitives.spheres, scene.spheres, "scene");
  function(view.primitives.scan, scene.scan_spheres, "scene");
  function(view.primitives.halves, scene.half_spheres, "scene");
  function(view.primitives.quads, scene.quads, "scene");
  function(view.filter.quantiles, scene.filter_quantiles, "scene");
  function(view.materials, scene.material_records, "scene");
  function(view.parameters, scene.parameters, "scene");
  function(view.emissions, scene.emissions, "scene");
  function(view.material_of, scene.material_of, "scene");
  function(view.sphere_frames, scene.sphere_frames, "scene");
  function(view.primitive_numbers, scene.primitive_numbers, "scene");
  function(view.lights, scene.lights, "scene");
  function(view.light_emission, scene.light_emission, "scene");
  function(view.bvh_nodes, scene.bvh_nodes, "acceleration structure");
  function(view.to_world, scene.to_world, "instances");
  function(view.corners, scene.corners, "vertex attributes");
  function(view.light_selector.lights, scene.light_list.lights, "lights");
  function(view.light_selector.table, scene.light_list.selection, "lights");
  function(view.light_selector.tree.pairs, scene.light_list.tree.pairs, "lights");
  function(view.light_selector.tree.trail, scene.light_list.tree.trail, "lights");
  function(view.light_map.first, scene.light_list.first, "lights");
  function(view.light_map.rank, scene.light_list.rank, "lights");
  function(view.light_map.spheres, scene.light_list.spheres, "lights");
  function(view.environment.texels, scene.environment_map.texels, "environment");
  function(view.environment.alias, scene.environment_map.alias, "environment");
  function(view.opacities, scene.opacities, "scene");
  function(view.media.list, scene.media, "scene");
  function(view.media.boundaries, scene.boundaries, "scene");
  function(view.light_points, scene.light_points, "lights");
  function(view.grids.grids, scene.grids, "grids");
  function(view.grids.values, scene.grid_values, "grids");
  function(view.grids.nodes, scene.grid_nodes, "grids");
  function(view.grids.majorants, scene.majorants, "grids");
  function(view.textures, scene.textures, "textures");
  function(view.texels, scene.texels, "textures");
}

}  // namespace pt
