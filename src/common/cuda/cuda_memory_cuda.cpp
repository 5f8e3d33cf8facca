#include <fmt/format.h>

#include "common/cuda/cuda_check.cuh"
#include "common/cuda/cuda_memory.cuh"
#include "common/error/memory_error.h"

namespace pt {

void check_cuda(cudaError_t status, const char* what) {
  if (status == cudaSuccess) return;
  const std::string message = fmt::format("CUDA: {}: {}", what, cudaGetErrorString(status));
  if (status == cudaErrorMemoryAllocation) {
    cudaGetLastError();  // clears it
    throw OutOfMemory(message);
  }
  throw Error(message);
}

CudaMemory::~CudaMemory() {
  for (void* pointer : pointers_) cudaFree(pointer);
}

std::uint64_t CudaMemory::free_bytes() {
  std::size_t free = 0, total = 0;
  check_cuda(cudaMemGetInfo(&free, &total), "cudaMemGetInfo");
  return free;
}

void* CudaMemory::allocate_bytes(const std::string& name, std::uint64_t size_bytes) {
  if (size_bytes == 0) return nullptr;
  void* pointer = nullptr;
  if (cudaMalloc(&pointer, size_bytes) != cudaSuccess) {
    cudaGetLastError();  // clears it
    throw OutOfMemory(memory_error("device memory", name, size_bytes, free_bytes()).what());
  }
  pointers_.push_back(pointer);
  for (BufferSize& entry : sizes_) {
    if (entry.name == name) {
      entry.size_bytes += size_bytes;
      return pointer;
    }
  }
  sizes_.push_back({name, size_bytes});
  return pointer;
}

void CudaMemory::copy_to_device(void* device, const void* host, std::uint64_t size_bytes) {
  if (size_bytes == 0) return;
  check_cuda(cudaMemcpy(device, host, size_bytes, cudaMemcpyHostToDevice), "cudaMemcpy");
}

}  // namespace pt
