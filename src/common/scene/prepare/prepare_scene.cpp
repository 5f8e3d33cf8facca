#include "common/scene/prepare/prepare_scene.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/accel/build/instance_tree.h"
#include "common/error/error.h"
#include "common/geometry/sphere.h"
#include "common/scene/data/scene_arrays.h"
#include "common/scene/prepare/list_lights.h"
#include "common/scene/prepare/prepare_filter.h"
#include "common/scene/prepare/prepare_steps.h"

namespace pt {

namespace {

/// Kernels without triangles know the paper's materials alone, which have no back.
bool needs_triangles(const MaterialDescription& material) {
  const bool has_black_back = material.one_sided && !is_black(material.parameters[0].value);
  return has_black_back || material.node != MaterialNode::none || !material.opacity.is_opaque() ||
         static_cast<int>(material.kind) >= PaperBsdfs::size;
}

}  // namespace

bool has_primitives_only(const SceneData& scene) {
  return !scene.moves() && !is_limited(scene.camera) && !scene.camera.orthographic &&
         scene.meshes.empty() && scene.delta_lights.empty() && scene.environment.width == 0 &&
         scene.sun.one_minus_cos == 0.0f && scene.textures.empty() && scene.sphere_frames.empty() &&
         scene.media.empty() && std::ranges::none_of(scene.materials, needs_triangles);
}

namespace {

/// Whether a sphere or an instance that moves or a mesh that deforms has a material for which
/// `is_wanted` is true.
template <class Wanted>
bool any_moves(const SceneData& scene, Wanted&& is_wanted) {
  for (const MotionData::MovingSphere& moving : scene.motion.spheres)
    if (is_wanted(scene.materials[scene.sphere_material[moving.sphere]])) return true;
  return std::ranges::any_of(scene.meshes, [&](const Mesh& mesh) {
    const auto is_of = [&](const MotionData::MovingInstance& moving) {
      return scene.instances[moving.instance].group == mesh.group;
    };
    return is_wanted(scene.materials[mesh.material]) &&
           (mesh.vertex_sets() > 1 || std::ranges::any_of(scene.motion.instances, is_of));
  });
}

/// Whether something that moves is filled with a medium whose grid stays where it is. (Around it
/// there may be one.)
bool has_moving_grids(const SceneData& scene) {
  const auto is_filled = [&](const MaterialDescription& m) {
    if (!m.is_boundary || m.media.inside == no_medium || m.media.inside == m.media.outside)
      return false;
    const Medium& medium = scene.media[m.media.inside];
    return medium.density_grid != no_grid || medium.albedo_grid != no_grid ||
           medium.emission_grid != no_grid;
  };
  return any_moves(scene, is_filled);
}

/// What edits of materials and lights may change.
void describe_shading(const SceneData& scene, SceneProperties& properties) {
  properties.has_emitters = std::ranges::any_of(
      scene.material_records, [](const Material& m) { return m.emission != no_emission; });
  properties.has_moving_grids = has_moving_grids(scene);
  properties.has_rough_conductors = std::ranges::any_of(scene.materials, is_rough_conductor);
  properties.bsdf_kinds = kinds_of(scene);
  properties.emitters = emitter_count(scene);
}

}  // namespace

SceneProperties properties_of(const SceneData& scene) {
  const auto is_masked = [](const MaterialDescription& m) { return !m.opacity.is_opaque(); };
  SceneProperties properties;
  properties.name = scene.name;
  properties.spheres = scene.spheres.size();
  properties.quads = scene.quads.size();
  properties.triangles = scene.triangle_count();
  properties.instances = scene.instances.size();
  if (!scene.instances.empty()) properties.tree_groups = groups_in_use(scene.instances).size();
  properties.is_primitive_only = has_primitives_only(scene);
  properties.has_motion = scene.moves();
  properties.deforms = scene.deforms();
  properties.has_moving_surfaces = properties.deforms || !scene.motion.instances.empty();
  properties.has_masks =
      is_limited(scene.camera) || std::ranges::any_of(scene.materials, is_masked);
  properties.has_media = needs_media(scene);
  properties.has_sparse = properties.has_media && !scene.grid_nodes.empty();
  properties.has_open_boundaries =
      scene.media_overlap ||
      std::ranges::any_of(scene.materials, [](const auto& m) { return m.passes; });
  describe_shading(scene, properties);
  constexpr std::size_t group = HalfSpheres::count;
  properties.scan_bytes = (scene.spheres.size() + group - 1) / group * sizeof(HalfSpheres);
  return properties;
}
namespace {

void prepare_primitives_only(SceneData& scene, Accel accel) {
  prepare_primitives(scene, accel != Accel::brute);
  scene.traits = {accel, Geometry::spheres_and_quads,
                  scene.lights.empty() ? Lighting::sky : Lighting::emitters};
}

/// How much farther from where the camera is described its motion takes its rays.
float motion_extent(const SceneData& scene) {
  const std::vector<TransformKey>& keys = scene.motion.camera;
  if (keys.empty()) return 0.0f;
  const Vec3 first = keys.front().to_world.translation();
  float most = 0.0f;
  for (const TransformKey& key : keys)
    most = std::max(most, glm::length(key.to_world.translation() - first));
  return most + 2.0f * glm::length(scene.camera.look_from - first);
}

void set_camera(SceneData& scene, const CameraParameters& camera, const Options& options) {
  scene.camera = camera;
  const CameraOverrides& own = options.camera;
  if (own.look_from || own.look_at || own.up) scene.motion.camera.clear();  // it stands there
  override_camera(scene.camera, options.camera);
  check_camera(scene.camera);
  if (scene.motion.camera.empty()) drop_idle_far_plane(scene);
  scene.camera_extent =
      camera_extent(scene.camera, options.width, options.height) + motion_extent(scene);
}

}  // namespace

bool move_camera(SceneData& scene, const CameraParameters& camera, const Options& options) {
  if (scene.primitive_count() > 0) return false;  // their bounds and scans depend on its place
  if (!scene.motion.camera.empty()) return false;
  const bool was_orthographic = scene.camera.orthographic, was_limited = is_limited(scene.camera);
  set_camera(scene, camera, options);
  return scene.camera.orthographic == was_orthographic && is_limited(scene.camera) == was_limited;
}

void hold_still(SceneData& scene) {
  scene.motion.camera.clear(), scene.motion.instances.clear(), scene.motion.spheres.clear();
  for (Mesh& mesh : scene.meshes) mesh.stop_deforming();
}

void resolve_scene(SceneData& scene, const Options& options) {
  if (scene.primitive_count() == 0 && scene.triangle_count() == 0) {
    throw Error(fmt::format("scene '{}' is empty: expected at least one primitive", scene.name));
  }
  set_camera(scene, scene.camera, options);
  prepare_motion(scene);
  prepare_materials(scene, options.multiple_scattering, options.integrator != IntegratorKind::mlt);
  prepare_media(scene);
  prepare_filter(scene, filter_of(options, scene));
  scene.properties = properties_of(scene);
}

void hold_still(SceneData& scene, const Options& options) {
  hold_still(scene);
  set_camera(scene, scene.camera, options);
  prepare_motion(scene);
  prepare_materials(scene, options.multiple_scattering, options.integrator != IntegratorKind::mlt);
  scene.properties = properties_of(scene);
}

void prepare_scene(SceneData& scene, const ExecutionPlan& plan) {
  if (plan.kernel_set == KernelSet::specialized) {
    prepare_primitives_only(scene, plan.accel);
  } else {
    prepare_triangles(scene, plan);
  }
  scene.properties.structure = plan.accel;
  scene.properties.why_structure = plan.why_accel;
  scene.properties.builder = plan.builder;
}

bool has_same_structure(const ExecutionPlan& a, const ExecutionPlan& b) {
  return a.kernel_set == b.kernel_set && a.accel == b.accel && a.builder == b.builder;
}

bool prepares_alike(const ExecutionPlan& a, const ExecutionPlan& b) {
  return has_same_structure(a, b) && a.light_selection == b.light_selection;
}

namespace {

/// What materials say of kernels and structure: the same before and after an edit that keeps both.
std::vector<bool> structure_by_materials(const SceneData& scene) {
  std::vector<bool> structure{std::ranges::any_of(scene.materials, needs_triangles),
                              !scene.opacities.empty(), scene.lights.empty()};
  for (const Mesh& mesh : scene.meshes) structure.push_back(mesh.masked);
  return structure;
}

bool resolve_shading(SceneData& scene, const SceneData& source, const Options& options) {
  const std::vector<bool> before = structure_by_materials(scene);
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const MediumBoundary media = scene.materials[i].media;  // numbered by prepare_media()
    scene.materials[i] = source.materials[i];
    scene.materials[i].media = media;
  }
  scene.delta_lights = source.delta_lights;
  scene.sky = source.sky, scene.sun = source.sun;
  prepare_materials(scene, options.multiple_scattering, options.integrator != IntegratorKind::mlt);
  list_emitters(scene);
  if (scene.traits.lighting == Lighting::full) scene.lights.clear();  // they are in light_list
  describe_shading(scene, scene.properties);
  return structure_by_materials(scene) == before;
}

}  // namespace

bool resolve_changes(SceneData& scene, const SceneData& source, const SceneChanges& changes,
                     const Options& options) {
  // What moves is prepared anew.
  const bool moves = scene.moves() || source.moves();
  if (changes.move_surfaces() && (scene.primitive_count() > 0 || !scene.media.empty() || moves))
    return false;
  if (changes.normals && scene.deforms()) return false;
  if (changes.camera && moves &&
      (!source.motion.camera.empty() || scene.motion.shutter != source.motion.shutter))
    return false;
  if (changes.instances) scene.instances = source.instances;
  for (std::size_t i = 0; i < source.meshes.size(); ++i) {
    if (changes.vertices) scene.meshes[i].positions = source.meshes[i].positions;
    if (changes.normals) scene.meshes[i].normals = source.meshes[i].normals;
  }
  // A far plane matters or not by where surfaces are.
  if ((changes.camera || changes.move_surfaces()) && !move_camera(scene, source.camera, options))
    return false;
  if (changes.shading && !resolve_shading(scene, source, options)) return false;
  if (changes.vertices) scene.properties.emitters = emitter_count(scene);
  return true;
}

void prepare_scene(SceneData& scene, const Options& options) {
  DeviceProperties device = cpu_properties(options.threads);
  device.is_cuda = is_on_cuda(options);
  device.has_ray_blocks = device.has_ray_blocks && !device.is_cuda;
  resolve_scene(scene, options);
  prepare_scene(scene, plan_execution(options, scene.properties, device));
}

Scene host_view(const SceneData& scene, int width, int height) {
  const auto count = [](const auto& values) { return static_cast<std::uint32_t>(values.size()); };
  Scene view;
  view.camera = make_camera(scene.camera, width, height);
  view.filter = scene.filter;
  view.sky = scene.sky;
  view.sun = scene.sun;
  view.sun.light = scene.light_list.sun;
  view.primitives.sphere_count = count(scene.spheres);
  view.primitives.quad_count = count(scene.quads);
  view.primitives.scan_count = count(scene.scan_spheres);
  view.primitives.scan_center = scene.scan_center;
  view.primitives.half_count = count(scene.half_spheres);
  view.primitives.half_scale = scene.half_scale;
  view.light_count = count(scene.lights);
  view.triangles = scene.tree.view();
  view.triangles.accel = scene.traits.accel;
  view.triangles.embree = scene.embree.get();
  view.light_selector.count = count(scene.light_list.selection);
  view.light_selector.table_first = scene.light_list.table_first;
  view.light_selector.table_probability = scene.light_list.table_probability;
  view.light_selector.tree.root = scene.light_list.tree.root;
  view.light_selector.total_weight = scene.light_list.total_weight;
  view.light_selector.environment_probability = scene.light_list.environment_probability;
  view.environment = scene.environment_map.view();
  view.media.overlap = scene.media_overlap;
  view.media.are_present = needs_media(scene);
  view.camera_medium_id = camera_medium_id(scene);
  view.light_point_count = count(scene.light_points);
  if (scene.motion.prepared) view.motion = &scene.motion.prepared->view;
  for_each_array(scene, view,
                 [](auto*& pointer, const auto& values, const char*) { pointer = values.data(); });
  return view;
}

}  // namespace pt
