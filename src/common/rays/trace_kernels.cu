#include "common/accel/trace_cuda/beam_cwbvh.cuh"
#include "common/accel/trace_cuda/instanced_lane.cuh"
#include "common/accel/trace_cuda/persistent_cwbvh.cuh"
#include "common/accel/traverse_brute.h"
#include "common/accel/traverse_bvh2.h"
#include "common/cuda/cuda_check.cuh"
#include "common/cuda/cuda_memory.cuh"
#include "common/cuda/used_gpu.cuh"
#include "common/rays/trace_kernels.cuh"

namespace pt {
namespace {

__device__ RayRecord load_ray(const RayRecord* ray) {
  const float4 a = __ldcs(reinterpret_cast<const float4*>(ray));
  const float4 b = __ldcs(reinterpret_cast<const float4*>(ray) + 1);
  return {{a.x, a.y, a.z}, a.w, {b.x, b.y, b.z}, b.w};
}

__device__ void store_hit(HitRecord* hit, float t, std::uint32_t primitive) {
  __stcs(reinterpret_cast<float2*>(hit), make_float2(t, __uint_as_float(primitive)));
}

template <class Query>
__device__ void store_result(const TriangleTree& tree, const Query& query, HitRecord* record) {
  const HitRecord hit = hit_record(tree, query);
  store_hit(record, hit.t, hit.primitive);
}

/// Hands the rays of an array to persistent warps, and takes their hits; see reserve_rays.
class RayQueue {
 public:
  __device__ RayQueue(const TriangleTree& tree, const RayArrays& arrays)
      : tree_(tree), arrays_(arrays) {}

  /// See PersistentTracer.
  __device__ std::uint32_t fetch(unsigned lane, ReservedRays& reserved, RayRecord& ray,
                                 int& count) const {
    const std::uint32_t first = reserve_rays(arrays_.next, arrays_.count, lane, reserved, count);
    if (static_cast<int>(lane) < count) ray = load_ray(arrays_.rays + first + lane);
    return first;
  }

  template <class Query>
  __device__ void finish(std::uint32_t ray_id, const Query& query) const {
    store_result(tree_, query, arrays_.hits + ray_id);
  }

 private:
  const TriangleTree& tree_;
  const RayArrays& arrays_;
};

constexpr int block_size = 128;
constexpr int blocks_least = 8;  // per multiprocessor: 64 registers for a thread

enum class Structure { brute, bvh2, cwbvh };

/// Blocks per multiprocessor that the compiler makes room for. It would rather save registers, and
/// loads a triangle's three parts one after the other then: a quarter slower for incoherent rays.
template <Structure structure, bool instanced>
inline constexpr int resident_least = structure == Structure::cwbvh ? (instanced ? 5 : 8)
                                      : instanced                   ? 8
                                                                    : 10;

template <Structure structure, bool instanced, class Query>
__global__ void __launch_bounds__(block_size, (resident_least<structure, instanced>))
    trace_by_threads(const __grid_constant__ TriangleTree tree,
                     const __grid_constant__ RayArrays arrays) {
  const std::uint32_t i = blockIdx.x * block_size + threadIdx.x;
  if (i >= arrays.count) return;
  const RayRecord ray = load_ray(arrays.rays + i);
  Query query(ray.t_min, ray.t_max);
  if constexpr (structure == Structure::brute) {
    traverse_triangles_brute<instanced>(tree, ray.ray(), query);
  } else if constexpr (structure == Structure::bvh2) {
    traverse_triangles_bvh2<instanced>(tree, ray.ray(), query);
  } else {
    traverse_cwbvh<instanced>(tree, ray.ray(), query);
  }
  store_result(tree, query, arrays.hits + i);
}

template <class Lane>
__global__ void __launch_bounds__(persistent_block<Lane>, persistent_blocks_least<Lane>)
    trace_by_persistent_warps(const __grid_constant__ TriangleTree tree,
                              const __grid_constant__ RayArrays arrays) {
  __shared__ PersistentMemory<Lane, persistent_block<Lane>> memory;
  RayQueue queue(tree, arrays);
  trace_persistent<Lane>(tree, memory, queue);
}

/// Apart from the beam's code: what few warps need must not cost all of them registers. By value:
/// references would keep the caller's variables in memory.
template <class Query>
__device__ __noinline__ Query trace_alone(const TriangleTree* tree, Ray ray, Query query) {
  traverse_cwbvh<false>(*tree, ray, query);
  return query;
}

template <class Query>
__global__ void __launch_bounds__(block_size, blocks_least)
    trace_by_beams(const __grid_constant__ TriangleTree tree,
                   const __grid_constant__ RayArrays arrays) {
  __shared__ BeamMemory memories[block_size / 32];
  const std::uint32_t i = blockIdx.x * block_size + threadIdx.x;
  const RayRecord ray = load_ray(arrays.rays + min(i, arrays.count - 1));
  Query query(ray.t_min, ray.t_max);
  if (!trace_beam(tree, ray.ray(), memories[threadIdx.x / 32], query))
    query = trace_alone(&tree, ray.ray(), Query(ray.t_min, ray.t_max));
  if (i < arrays.count) store_result(tree, query, arrays.hits + i);
}

constexpr std::uint32_t sampled_groups = 2048;

__global__ void __launch_bounds__(block_size)
    count_coherent_groups(const __grid_constant__ RayArrays arrays, std::uint32_t* count) {
  __shared__ Beam beams[block_size / 32];
  const std::uint32_t groups = arrays.count / 32;
  const std::uint32_t sample = (blockIdx.x * block_size + threadIdx.x) / 32;
  const auto group = static_cast<std::uint32_t>(std::uint64_t{sample} * groups / sampled_groups);
  const RayRecord record = load_ray(arrays.rays + 32 * group + threadIdx.x % 32);
  const CwbvhRay ray = make_cwbvh_ray(record.ray());
  const bool is_coherent = make_beam(ray.origin, ray.inverse, beams[threadIdx.x / 32]);
  if (__all_sync(0xffffffffu, is_coherent) && threadIdx.x % 32 == 0) atomicAdd(count, 1u);
}

using Kernel = void (*)(const TriangleTree, const RayArrays);

template <bool instanced, class Query>
Kernel choose_threads(const TriangleTree& tree) {
  if (tree.cwbvh != nullptr) return trace_by_threads<Structure::cwbvh, instanced, Query>;
  if (tree.bvh2 != nullptr) return trace_by_threads<Structure::bvh2, instanced, Query>;
  return trace_by_threads<Structure::brute, instanced, Query>;
}

template <class Query>
Kernel choose_kernel(TraceVariant variant, const TriangleTree& tree) {
  if (variant == TraceVariant::beam) return trace_by_beams<Query>;
  return tree.instance_count > 0 ? choose_threads<true, Query>(tree)
                                 : choose_threads<false, Query>(tree);
}

struct PersistentKernel {
  Kernel kernel;
  int block_size;
};

template <class Lane>
PersistentKernel persistent_kernel() {
  return {trace_by_persistent_warps<Lane>, persistent_block<Lane>};
}

PersistentKernel choose_persistent(RayType type, const TriangleTree& tree) {
  const bool any = type == RayType::any;
  if (tree.instance_count > 0) {
    return any ? persistent_kernel<InstancedLane<AnyTriangle>>()
               : persistent_kernel<InstancedLane<ClosestTriangle>>();
  }
  return any ? persistent_kernel<CwbvhLane<AnyTriangle, true>>()
             : persistent_kernel<CwbvhLane<ClosestTriangleId, true>>();
}

}  // namespace

int persistent_blocks(RayType type, const TriangleTree& tree) {
  const auto [kernel, threads] = choose_persistent(type, tree);
  int per_multiprocessor = 0;
  check_cuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&per_multiprocessor, kernel, threads, 0),
             "cudaOccupancyMaxActiveBlocksPerMultiprocessor");
  return used_multiprocessors() * per_multiprocessor;
}

void launch_trace(TraceVariant variant, RayType type, const TriangleTree& tree,
                  const RayArrays& rays, int blocks) {
  if (rays.count == 0) return;
  if (variant == TraceVariant::persistent) {
    const auto [kernel, threads] = choose_persistent(type, tree);
    kernel<<<static_cast<unsigned>(blocks), static_cast<unsigned>(threads)>>>(tree, rays);
  } else {
    const Kernel kernel = type == RayType::any ? choose_kernel<AnyTriangle>(variant, tree)
                                               : choose_kernel<ClosestTriangle>(variant, tree);
    kernel<<<(rays.count + block_size - 1) / block_size, block_size>>>(tree, rays);
  }
  check_cuda(cudaGetLastError(), "launching the tracing of rays");
}

double measure_coherence(const RayArrays& rays) {
  if (rays.count < 32) return 0.0;
  check_cuda(cudaMemset(rays.next, 0, sizeof(std::uint32_t)), "cudaMemset");
  count_coherent_groups<<<sampled_groups * 32 / block_size, block_size>>>(rays, rays.next);
  std::uint32_t count = 0;
  check_cuda(cudaMemcpy(&count, rays.next, sizeof count, cudaMemcpyDeviceToHost),
             "measuring the coherence of rays");
  return static_cast<double>(count) / sampled_groups;
}

}  // namespace pt
