#include "common/accel/trace_optix/optix_memory_cuda.h"

#include "common/cuda/cuda_check.cuh"
#include "common/error/host_memory.h"

namespace pt {
void* CudaOptixMemory::allocate(std::size_t bytes, const char* what) {
  void* memory = nullptr;
  if (bytes == 0) return memory;
  if (cudaMalloc(&memory, bytes) == cudaSuccess) return memory;
  cudaGetLastError();  // clears it
  std::size_t free = 0, total = 0;
  check_cuda(cudaMemGetInfo(&free, &total), "cudaMemGetInfo");
  throw OutOfMemory(memory_error("device memory", what, bytes, free).what());
}

void CudaOptixMemory::release(void* memory) noexcept { cudaFree(memory); }

void CudaOptixMemory::to_device(void* to, const void* from, std::size_t bytes) {
  check_cuda(cudaMemcpyAsync(to, from, bytes, cudaMemcpyHostToDevice, stream_), "cudaMemcpyAsync");
  synchronize();
}

void CudaOptixMemory::to_host(void* to, const void* from, std::size_t bytes) {
  check_cuda(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToHost, stream_), "cudaMemcpyAsync");
  synchronize();
}

// From memory that is not pinned, which CUDA reads before it returns.
void CudaOptixMemory::enqueue_to_device(void* to, const void* from, std::size_t bytes) {
  check_cuda(cudaMemcpyAsync(to, from, bytes, cudaMemcpyHostToDevice, stream_), "cudaMemcpyAsync");
}

void CudaOptixMemory::synchronize() {
  check_cuda(cudaStreamSynchronize(stream_), "what OptiX runs");
}

}  // namespace pt
