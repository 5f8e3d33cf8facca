#include <cuda_runtime_api.h>

#include "common/accel/build_cuda/device_triangle_tree.cuh"
#include "common/cuda/cuda_check.cuh"
#include "common/cuda/cuda_memory.cuh"
#include "common/cuda/used_gpu.cuh"
#include "common/error/error.h"
#include "common/rays/trace_kernels.cuh"
#include "common/rays/trace_rays.h"

namespace pt {
namespace {

constexpr double coherent_part = 0.5;  // of the groups of rays from which on beams pay

TriangleTree upload(const TriangleTreeData& tree, CudaMemory& memory) {
  return tree.view([&](auto*& pointer, const auto& values, const char* kind) {
    pointer = memory.upload(kind, values);
  });
}

TraceVariant choose_variant(TraceVariant wanted, const TriangleTree& tree, const RayArrays& rays) {
  const bool is_wide = tree.cwbvh != nullptr, is_plain = tree.instance_count == 0;
  if (wanted == TraceVariant::automatic) {
    if (!is_wide) return TraceVariant::threads;
    const bool is_coherent = is_plain && measure_coherence(rays) >= coherent_part;
    return is_coherent ? TraceVariant::beam : TraceVariant::persistent;
  }
  if (wanted != TraceVariant::threads && !is_wide)
    throw Error("--variant: persistent and beam trace a cwbvh");
  if (wanted == TraceVariant::beam && !is_plain)
    throw Error("--variant: beam traces a cwbvh without instances");
  return wanted;
}

TraceResult trace(const TriangleTree& view, const RaySet& set, const TraceRuns& runs,
                  CudaMemory& memory) {
  const auto count = static_cast<std::uint32_t>(set.rays.size());
  const RayArrays rays = {memory.upload("rays", set.rays),
                          memory.allocate<HitRecord>("hits", set.rays.size()), count,
                          memory.allocate<std::uint32_t>("counter", 1)};
  TraceResult result;
  result.variant = choose_variant(runs.variant, view, rays);
  const int blocks = persistent_blocks(set.type, view);
  const CudaEvent begin, end;
  for (int run = -runs.warmup; run < runs.repeat; ++run) {
    check_cuda(cudaMemset(rays.next, 0, sizeof(std::uint32_t)), "cudaMemset");
    begin.record();
    launch_trace(result.variant, set.type, view, rays, blocks);
    end.record();
    const double ms = end.ms_since(begin);
    if (run >= 0) result.times_ms.push_back(ms);
  }
  result.hits.resize(set.rays.size());
  check_cuda(cudaMemcpy(result.hits.data(), rays.hits, result.hits.size() * sizeof(HitRecord),
                        cudaMemcpyDeviceToHost),
             "reading the hits");
  return result;
}

}  // namespace

TraceResult trace_rays_cuda(const TriangleTreeData& tree, const RaySet& rays, const TraceRuns& runs,
                            int index, int sms) {
  const UsedGpu device(index, sms);
  CudaMemory memory;
  return trace(upload(tree, memory), rays, runs, memory);
}

BuiltTrace build_and_trace_cuda(std::span<const Mesh> meshes, std::span<const Instance> instances,
                                const TreeOptions& tree, const RaySet& rays, const TraceRuns& runs,
                                int index, int sms) {
  check_geometry(meshes, instances);
  const UsedGpu device(index, sms);
  CudaMemory memory;
  const DeviceTriangleTree built = build_device_triangle_tree(meshes, instances, tree, memory);
  return {trace(built.view, rays, runs, memory), built.summary};
}

}  // namespace pt
