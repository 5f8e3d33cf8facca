#include <algorithm>
#include <map>
#include <span>

#include "common/accel/build/build_nodes.h"
#include "common/accel/build/build_triangle_tree.h"
#include "common/accel/build/instance_tree.h"
#include "common/accel/embree/embree_tree.h"
#include "common/scene/data/scene_data.h"
#include "common/scene/data/scene_facts.h"
#include "common/scene/prepare/list_lights.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/scene/prepare/prepare_steps.h"

namespace pt {

void convert_quads(SceneData& scene) {
  std::map<std::uint32_t, Mesh> by_material;
  for (std::size_t i = 0; i < scene.quads.size(); ++i) {
    const Quad& quad = scene.quads[i];
    Mesh& mesh = by_material[scene.quad_material[i]];
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const Vec3 a = quad.corner + quad.edge_a, b = quad.corner + quad.edge_b;
    mesh.positions.insert(mesh.positions.end(), {quad.corner, a, a + quad.edge_b, b});
    mesh.uvs.insert(mesh.uvs.end(), {{0, 0}, {1, 0}, {1, 1}, {0, 1}});
    mesh.triangles.push_back({{first, first + 1, first + 2}});
    mesh.triangles.push_back({{first, first + 2, first + 3}});
  }
  for (auto& [material, mesh] : by_material) {
    mesh.material = material;
    mesh.masked = is_masked(scene, scene.materials[material]);
    scene.meshes.push_back(std::move(mesh));
  }
  scene.quads.clear();
  scene.quad_material.clear();
}
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

/// A plane of a node's boxes, of 12: minima and maxima take turns.
float& plane_of(Bvh2Node& node, int i) { return i < 8 ? node.xy[i / 4][i % 4] : node.z[i - 8]; }

/// Widens planes of boxes at all sets of vertices by what interpolation between them rounds.
void widen(std::span<float* const> planes, bool is_maximum) {
  float size = 0;
  for (const float* plane : planes) size = std::max(size, std::abs(*plane));
  for (float* plane : planes) *plane += (is_maximum ? 8.0f : -8.0f) * half_ulp * size;
}

void widen_nodes(std::vector<Bvh2Node>& first, std::vector<Bvh2Node>& later, std::size_t count) {
  if (count == 0) return;
  std::vector<float*> planes(1 + later.size() / count);
  for (std::size_t n = 0; n < count; ++n) {
    for (int i = 0; i < 12; ++i) {
      planes[0] = &plane_of(first[n], i);
      for (std::size_t set = 1; set < planes.size(); ++set)
        planes[set] = &plane_of(later[(set - 1) * count + n], i);
      widen(planes, i % 2 != 0);
    }
  }
}

/// The tree, fitted to all sets of vertices; its upper level to all of the time.
void prepare_deformation(SceneData& scene) {
  const std::size_t sets = scene.vertex_sets();
  if (sets == 1) return;
  TriangleTreeData& tree = scene.tree;
  PreparedMotion& motion = *scene.motion.prepared;
  std::vector<Mesh> meshes = scene.meshes;
  for (Mesh& mesh : meshes) mesh.stop_deforming();
  TriangleTreeData then = tree;
  const auto append = [](auto& all, const auto& set, std::size_t count) {
    all.insert(all.end(), set.begin(), set.begin() + static_cast<std::ptrdiff_t>(count));
  };
  const bool is_flat = tree.instances.empty();
  const std::size_t nodes = is_flat             ? tree.bvh2.size()
                            : tree.bvh2.empty() ? 0
                                                : tree.first_top_node;
  for (std::size_t set = 1; set < sets; ++set) {
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      if (scene.meshes[i].vertex_sets() == 1) continue;
      meshes[i].positions = scene.meshes[i].positions_of(set);
      meshes[i].normals = scene.meshes[i].normals_of(set);
    }
    refit_triangle_tree(then, meshes, scene.instances);
    append(motion.later_triangles, then.triangles, then.triangles.size());
    append(motion.later_nodes, then.bvh2, nodes);
    if (!scene.corners.empty())
      append(motion.later_corners, list_corners(meshes), scene.corners.size());
    for (std::size_t i = 0; i < tree.groups.size(); ++i)
      tree.groups[i].bounds.grow(then.groups[i].bounds);
  }
  widen_nodes(tree.bvh2, motion.later_nodes, nodes);
  for (GroupTree& group : tree.groups) {
    for (int axis = 0; axis < 3; ++axis) {
      float *low = &group.bounds.min[axis], *high = &group.bounds.max[axis];
      widen({&low, 1}, false), widen({&high, 1}, true);
    }
  }
  rebuild_instance_tree(tree, scene.instances, scene.motion.tracks());
  motion.view.vertex_steps = static_cast<std::uint32_t>(sets - 1);
  motion.update_view();
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

void prepare_triangles(SceneData& scene, const ExecutionPlan& plan) {
  const Accel accel = plan.accel;
  convert_quads(scene);
  if (!scene.media.empty()) separate_boundaries(scene);
  const Bounds bounds = scene_bounds(scene);
  prepare_primitives(scene, !scene.spheres.empty(), bounds);
  prepare_moving_spheres(scene);
  scene.lights.clear();  // they are in light_list
  const bool masked = !scene.opacities.empty();
  const bool mixed = scene.moves() || masked || !scene.instances.empty() ||
                     !scene.spheres.empty() || accel == Accel::brute || accel == Accel::embree;
  scene.traits = {accel,        mixed ? Geometry::mixed : Geometry::triangles,   Lighting::full,
                  masked,       needs_media(scene) || (masked && scene.moves()), false,
                  scene.moves()};
  const TreeOptions tree = tree_options(accel, plan.builder);
  if (is_device_builder(plan.builder)) {
    check_geometry(scene.meshes, scene.instances);
  } else {
    scene.tree = build_triangle_tree(scene.meshes, scene.instances, tree, scene.motion.tracks());
    if (accel == Accel::embree) scene.embree = std::make_shared<const EmbreeTree>(scene.tree);
  }
  scene.corners = list_corners(scene.meshes);
  prepare_deformation(scene);
  if (!scene.instances.empty()) scene.to_world = instance_transforms(scene);
  scene.light_list = list_lights(scene, bounds, plan.light_selection);
  prepare_moving_lights(scene);
  if (scene.environment.width > 0) {
    scene.environment_map = make_environment(scene.environment.width, scene.environment.height,
                                             scene.environment.pixels, scene.environment.to_world);
  }
}
namespace {

/// Of a refitted tree's cost over that when it was built: from here on a new tree is worth its
/// time.
constexpr double refit_cost_max = 4.0 / 3.0;

TreeFacts facts_of_tree(const SceneData& scene) {
  return tree_facts(summarize(scene.tree), scene.triangle_count());
}

}  // namespace

void prepare_changes(SceneData& scene, const SceneChanges& changes, const ExecutionPlan& plan,
                     TreeFacts& tree, double& built_cost) {
  if (scene.traits.lighting != Lighting::full) return;
  if (changes.move_surfaces()) {
    scene.embree.reset();  // it has pointers into the tree
    if (is_device_builder(plan.builder)) {
      check_geometry(scene.meshes, scene.instances);
    } else if (changes.vertices) {
      refit_triangle_tree(scene.tree, scene.meshes, scene.instances);
    } else {
      rebuild_instance_tree(scene.tree, scene.instances);
    }
    tree = facts_of_tree(scene);
    if (changes.vertices && tree.sah_cost > refit_cost_max * built_cost) {
      scene.tree = build_triangle_tree(scene.meshes, scene.instances,
                                       tree_options(plan.accel, plan.builder));
      tree = facts_of_tree(scene);
      built_cost = tree.sah_cost;
    }
    if (plan.accel == Accel::embree) scene.embree = std::make_shared<const EmbreeTree>(scene.tree);
  }
  if (changes.normals) scene.corners = list_corners(scene.meshes);
  if (changes.instances && !scene.instances.empty()) scene.to_world = instance_transforms(scene);
  if (changes.lights || changes.move_surfaces()) {
    scene.light_list = list_lights(scene, scene_bounds(scene), plan.light_selection);
    prepare_moving_lights(scene);
  }
}

}  // namespace pt
