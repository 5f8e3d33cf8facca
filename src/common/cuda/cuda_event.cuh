// A mark on a CUDA stream, and the time between two of them.
#pragma once

#include <cuda_runtime_api.h>

#include "common/cuda/cuda_check.cuh"

namespace pt {

class CudaEvent {
 public:
  CudaEvent() { check_cuda(cudaEventCreate(&event_), "cudaEventCreate"); }
  CudaEvent(const CudaEvent&) = delete;
  CudaEvent& operator=(const CudaEvent&) = delete;
  ~CudaEvent() { cudaEventDestroy(event_); }

  void record(cudaStream_t stream = nullptr) const {
    check_cuda(cudaEventRecord(event_, stream), "cudaEventRecord");
  }

  /// Waits for this mark; milliseconds since `begin`.
  double ms_since(const CudaEvent& begin) const {
    float ms = 0;
    check_cuda(cudaEventSynchronize(event_), "waiting for kernels");
    check_cuda(cudaEventElapsedTime(&ms, begin.event_, event_), "cudaEventElapsedTime");
    return ms;
  }

 private:
  cudaEvent_t event_ = nullptr;
};

}  // namespace pt
