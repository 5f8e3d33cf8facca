#include "common/scene/prepare/prepare_triangles.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/accel/build/build_nodes.h"
#include "common/accel/build/build_triangle_tree.h"
#include "common/accel/embree/embree_tree.h"
#include "common/error/error.h"
#include "common/scene/data/frame_scene.h"
#include "common/scene/prepare/convert_quads.h"
#include "common/scene/prepare/list_lights.h"
#include "common/scene/prepare/prepare_materials.h"
#include "common/scene/prepare/prepare_media.h"
#include "common/scene/prepare/prepare_primitives.h"

namespace pt {
namespace {

/// By triangle, counted through the meshes; empty where none has attributes.
std::vector<CornerAttributes> list_corners(const std::vector<Mesh>& meshes) {
  std::vector<CornerAttributes> corners;
  const auto has_any = [](const Mesh& mesh) { return !mesh.normals.empty() || !mesh.uvs.empty(); };
  if (std::none_of(meshes.begin(), meshes.end(), has_any)) return corners;
  for (const Mesh& mesh : meshes) {
    for (const TriangleIndices& triangle : mesh.triangles) {
      CornerAttributes& all = corners.emplace_back();
      for (int i = 0; i < 3; ++i) {
        if (!mesh.normals.empty()) all.normal[i] = mesh.normals[triangle.v[i]];
        if (!mesh.uvs.empty()) all.uv[i] = mesh.uvs[triangle.v[i]];
      }
    }
  }
  return corners;
}

/// In the order of InstanceRecord::number: the meshes of group 0 come last.
std::vector<Affine> instance_transforms(const SceneData& scene) {
  std::vector<Affine> transforms;
  for (const Instance& instance : scene.instances) transforms.push_back(instance.to_world);
  transforms.emplace_back();
  return transforms;
}

}  // namespace

TreeOptions tree_options(Accel accel, TreeBuilder builder) {
  TreeOptions options;
  options.accel = has_nodes(accel_kind_of(accel)) ? accel_kind_of(accel) : AccelKind::brute;
  options.builder = builder;
  return options;
}

void prepare_triangles(SceneData& scene, const Options& options, Accel accel) {
  convert_quads(scene);
  if (!scene.media.empty()) separate_boundaries(scene);
  const Bounds bounds = scene_bounds(scene);
  prepare_primitives(scene, !scene.spheres.empty(), bounds);
  scene.lights.clear();  // they are in light_list
  const bool masked = !scene.opacities.empty();
  const bool mixed = masked || !scene.instances.empty() || !scene.spheres.empty() ||
                     accel == Accel::brute || accel == Accel::embree;
  scene.traits = {accel, mixed ? Geometry::mixed : Geometry::triangles, Lighting::full, masked,
                  needs_media(scene)};
  const TreeOptions tree = tree_options(accel, options.builder);
  if (is_device_builder(options.builder)) {
    check_geometry(scene.meshes, scene.instances);
  } else {
    scene.tree = build_triangle_tree(scene.meshes, scene.instances, tree);
    if (accel == Accel::embree) scene.embree = std::make_shared<const EmbreeTree>(scene.tree);
  }
  scene.corners = list_corners(scene.meshes);
  if (!scene.instances.empty()) scene.to_world = instance_transforms(scene);
  scene.light_list = list_lights(scene, bounds, options.light_selection);
  if (scene.environment.width > 0) {
    scene.environment_map = make_environment(scene.environment.width, scene.environment.height,
                                             scene.environment.pixels, scene.environment.to_world);
  }
}

}  // namespace pt
