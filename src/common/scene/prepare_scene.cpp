#include "common/scene/prepare_scene.h"

#include <fmt/format.h>

#include "common/error.h"
#include "common/scene/prepare_camera.h"
#include "common/scene/prepare_filter.h"
#include "common/scene/prepare_materials.h"
#include "common/scene/prepare_primitives.h"
#include "common/scene/prepare_triangles.h"
#include "common/scene/scene_arrays.h"
#include "common/scene/scene_options.h"

namespace pt {
namespace {

// Whether testing every primitive is faster than walking a tree: results/ has the measurement. CUDA
// passes over spheres in half precision; a stage that walks a tree waits for the slowest ray of its
// warp, a megakernel less so, since threads that are done with theirs take the next step. The
// paper's toggles have kernels on CUDA for brute force alone.
bool is_small(const SceneData& scene, const Options& options) {
  constexpr std::size_t primitives_max = 96;
  if (is_on_cuda(options) && is_toggled(options)) return true;
  const std::size_t half_spheres_max = options.mode == Mode::wavefront ? 384 : 224;
  return scene.primitive_count() <= primitives_max ||
         (is_on_cuda(options) && scene.quads.empty() && scene.spheres.size() <= half_spheres_max);
}

void prepare_primitives_only(SceneData& scene, const Options& options) {
  const bool brute = options.accel == AccelKind::brute ||
                     (options.accel == AccelKind::automatic && is_small(scene, options));
  prepare_primitives(scene, !brute);
  scene.traits = {brute ? Accel::brute : Accel::bvh2, Geometry::spheres_and_quads,
                  scene.lights.empty() ? Lighting::sky : Lighting::emitters};
}

}  // namespace

void prepare_scene(SceneData& scene, const Options& options) {
  if (scene.primitive_count() == 0 && scene.triangle_count() == 0) {
    throw Error(fmt::format("scene '{}' is empty: expected at least one primitive", scene.name));
  }
  override_camera(scene.camera, options.camera);
  check_camera(scene.camera);
  drop_idle_clips(scene, options.width, options.height);
  check_scene_options(options, scene);
  prepare_materials(scene, options.multiple_scattering);
  prepare_filter(scene, filter_of(options, scene));
  if (has_specialized_kernels(scene, options)) {
    prepare_primitives_only(scene, options);
  } else {
    prepare_triangles(scene, options);
  }
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
  view.triangles.embree = scene.embree.get();
  view.light_selector.count = count(scene.light_list.selection);
  view.light_selector.table_first = scene.light_list.table_first;
  view.light_selector.table_probability = scene.light_list.table_probability;
  view.light_selector.tree.root = scene.light_list.tree.root;
  view.light_selector.total_weight = scene.light_list.total_weight;
  view.light_selector.environment_probability = scene.light_list.environment_probability;
  view.environment = scene.environment_map.view();
  for_each_array(scene, view,
                 [](auto*& pointer, const auto& values, const char*) { pointer = values.data(); });
  return view;
}

}  // namespace pt
