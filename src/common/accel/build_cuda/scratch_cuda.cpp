#include <cuda_runtime_api.h>
#include <fmt/format.h>

#include "common/accel/build_cuda/scratch.cuh"
#include "common/cuda/cuda_check.cuh"
#include "common/error/error.h"

namespace pt::device_build {

void Scratch::release() {
  cudaFree(memory_);
  memory_ = nullptr;
  capacity_ = 0;
}

void Scratch::reserve(std::uint64_t size_bytes) {
  release();
  if (cudaMalloc(&memory_, size_bytes) != cudaSuccess) {
    cudaGetLastError();  // clears it
    std::size_t free = 0, total = 0;
    check_cuda(cudaMemGetInfo(&free, &total), "cudaMemGetInfo");
    throw Error(fmt::format(
        "not enough device memory: building a tree needs {} MiB for a while, {} MiB are free",
        size_bytes >> 20, free >> 20));
  }
  capacity_ = size_bytes;
}

}  // namespace pt::device_build
