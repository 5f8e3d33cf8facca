#include "app/trace_mesh.h"

#include <fmt/format.h>

#include "common/accel/build/build_triangle_tree.h"
#include "common/error/error.h"
#include "common/options/option_names.h"

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
    return trace_rays_cuda(tree, rays, runs, device.choice.index);
#endif
  return trace_rays_cpu(tree, rays, runs);
}

BuiltTrace build_and_trace(const SceneData& scene, const TreeOptions& options, const RaySet& rays,
                           const TraceRuns& runs, const DeviceInfo& device) {
#ifdef PTEXP_CUDA
  if (is_device_builder(options.builder))
    return build_and_trace_cuda(scene.meshes, scene.instances, options, rays, runs,
                                device.choice.index);
#endif
  const TriangleTreeData tree = build_triangle_tree(scene.meshes, scene.instances, options);
  return {trace_tree(tree, rays, runs, device), summarize(tree)};
}

}  // namespace pt
