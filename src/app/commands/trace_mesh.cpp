#include <fmt/format.h>

#include "app/commands/commands.h"
#include "app/render/make_renderer.h"
#include "common/accel/build/build_triangle_tree.h"
#include "common/error/error.h"
#include "common/options/option_names.h"
#include "common/rays/ray_file.h"
#include "common/scene/prepare/prepare_scene.h"
#include "common/scene/prepare/prepare_steps.h"

namespace pt {

void check_tracing(const TreeOptions& options, const TraceRuns& runs, const DeviceInfo& device) {
  const bool is_cpu = device.choice.kind == DeviceChoice::Kind::cpu;
  check_builder(options.builder, options.accel, !is_cpu);
  if (options.accel == AccelKind::brute && options.builder != TreeBuilder::automatic)
    throw Error(fmt::format("--builder {}: has no effect with --accel brute: there is no tree",
                            to_string(options.builder)));
  if (is_cpu && runs.variant != TraceVariant::automatic)
    throw Error("--variant: has no effect on the CPU");
}

TraceResult trace_tree(const TriangleTreeData& tree, const RaySet& rays, const TraceRuns& runs,
                       [[maybe_unused]] const DeviceInfo& device) {
#ifdef PTEXP_CUDA
  if (device.choice.kind == DeviceChoice::Kind::cuda)
    return trace_rays_cuda(tree, rays, runs, device.choice.index, device.sms);
#endif
  return trace_rays_cpu(tree, rays, runs);
}

BuiltTrace build_and_trace(const SceneData& scene, const TreeOptions& options, const RaySet& rays,
                           const TraceRuns& runs, const DeviceInfo& device) {
#ifdef PTEXP_CUDA
  if (is_device_builder(options.builder))
    return build_and_trace_cuda(scene.meshes, scene.instances, options, rays, runs,
                                device.choice.index, device.sms);
#endif
  const TriangleTreeData tree = build_triangle_tree(scene.meshes, scene.instances, options);
  return {trace_tree(tree, rays, runs, device), summarize(tree)};
}

SceneData load_traced_scene(const std::string& name) {
  SceneData scene;
  if (name.ends_with(".mesh")) {
    scene.meshes.push_back(read_trace_mesh(name));
    scene.add_material(MaterialDescription());
  } else {
    Options options;
    options.scene = name;
    scene = load_scene(options, choose_device({DeviceChoice::Kind::cpu, 0}));
    hold_still(scene);  // rays in a file have no time
    convert_quads(scene);
  }
  scene.name = name;
  return scene;
}

SceneData load_triangles(const std::string& name) {
  SceneData scene = load_traced_scene(name);
  scene.spheres.clear();
  scene.motion.spheres.clear();
  scene.sphere_material.clear();
  if (scene.triangle_count() == 0) throw Error(fmt::format("{}: has no triangles", name));
  return scene;
}

}  // namespace pt
