#include "common/scene/prepare_scene.h"

#include <fmt/format.h>

#include "common/error.h"
#include "common/render/option_names.h"
#include "common/scene/prepare_camera.h"
#include "common/scene/prepare_materials.h"
#include "common/scene/prepare_primitives.h"
#include "common/scene/prepare_triangles.h"

namespace pt {
namespace {

// Up to here testing every primitive is faster than walking a tree: results/ has the measurement.
constexpr std::size_t brute_force_max = 96;

/// Whether the lean kernels of the paper's scenes can render it.
bool has_primitives_only(const SceneData& scene) {
  return scene.meshes.empty() && scene.delta_lights.empty() && scene.environment.width == 0 &&
         scene.textures.empty();
}

void prepare_primitives_only(SceneData& scene, const Options& options) {
  if (options.accel == AccelKind::cwbvh || options.accel == AccelKind::embree) {
    throw Error(
        fmt::format("--accel {}: holds triangles; scene '{}' has spheres and quads only, expected "
                    "brute or bvh2",
                    options.accel == AccelKind::cwbvh ? "cwbvh" : "embree", scene.name));
  }
  if (options.builder != TreeBuilder::automatic) {
    throw Error(fmt::format("--builder {}: builds trees over triangles; scene '{}' has none",
                            to_string(options.builder), scene.name));
  }
  const bool brute =
      options.accel == AccelKind::brute ||
      (options.accel == AccelKind::automatic && scene.primitive_count() <= brute_force_max);
  prepare_primitives(scene, !brute);
  scene.traits = {brute ? Accel::brute : Accel::bvh2, Geometry::spheres_and_quads,
                  scene.lights.empty() ? Lighting::sky : Lighting::emitters};
}

}  // namespace

void prepare_scene(SceneData& scene, const Options& options) {
  if (scene.primitive_count() == 0 && scene.triangle_count() == 0) {
    throw Error(fmt::format("scene '{}' is empty: expected at least one primitive", scene.name));
  }
  prepare_materials(scene);
  override_camera(scene.camera, options.camera);
  check_camera(scene.camera);
  if (has_primitives_only(scene)) {
    prepare_primitives_only(scene, options);
  } else {
    prepare_triangles(scene, options);
  }
}

Scene host_view(const SceneData& scene, int width, int height) {
  Scene view;
  view.camera = make_camera(scene.camera, width, height);
  view.sky = scene.sky;
  view.primitives = {scene.spheres.data(), scene.quads.data(),
                     static_cast<std::uint32_t>(scene.spheres.size()),
                     static_cast<std::uint32_t>(scene.quads.size())};
  view.primitives.scan = scene.scan_spheres.data();
  view.primitives.scan_count = static_cast<std::uint32_t>(scene.scan_spheres.size());
  view.primitives.scan_center = scene.scan_center;
  view.bvh_nodes = scene.bvh_nodes.data();
  view.materials = scene.material_records.data();
  view.parameters = scene.parameters.data();
  view.emissions = scene.emissions.data();
  view.material_of = scene.material_of.data();
  view.lights = scene.lights.data();
  view.light_emission = scene.light_emission.data();
  view.light_count = static_cast<std::uint32_t>(scene.lights.size());
  view.triangles = scene.tree.view();
  view.triangles.embree = scene.embree.get();
  view.attributes = {scene.attributes.triangles.data(), scene.attributes.normals.data(),
                     scene.attributes.uvs.data()};
  view.to_world = scene.to_world.data();
  const LightListData& list = scene.light_list;
  view.light_selector = {list.lights.data(), list.selection.data(),
                         static_cast<std::uint32_t>(list.lights.size()), list.total_weight,
                         list.environment_probability};
  view.light_map = {list.first.data(), list.rank.data(), list.spheres.data()};
  view.environment = scene.environment_map.view();
  view.textures = scene.textures.data();
  view.texels = scene.texels.data();
  return view;
}

}  // namespace pt
