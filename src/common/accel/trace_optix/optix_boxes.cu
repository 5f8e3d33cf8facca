#include "common/accel/trace_optix/optix_memory_cuda.h"
#include "common/cuda/cuda_check.cuh"

namespace pt {
namespace {

__global__ void box_kernel(optix::Box* boxes, const Triangle* triangles, std::size_t count,
                           OptixBoxMargin margin) {
  const std::size_t i = std::size_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (i < count) boxes[i] = optix_box(load_wide(&triangles[i]), margin);
}

}  // namespace

void CudaOptixMemory::enqueue_boxes(optix::Box* boxes, const Triangle* triangles, std::size_t count,
                                    const OptixBoxMargin& margin) {
  if (count == 0) return;
  constexpr unsigned block = 256;
  box_kernel<<<static_cast<unsigned>((count + block - 1) / block), block, 0, stream_>>>(
      boxes, triangles, count, margin);
  check_cuda(cudaGetLastError(), "OptiX's boxes");
}

}  // namespace pt
