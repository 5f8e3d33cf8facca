// CUDA errors as exceptions that name the call; events on a stream.
#pragma once

#include <cuda_runtime_api.h>

namespace pt {

/// Throws Error("CUDA: <what>: <reason>") unless `status` is cudaSuccess: OutOfMemory where it is
/// cudaErrorMemoryAllocation.
void check_cuda(cudaError_t status, const char* what);

/// A mark on a CUDA stream, from which the time to another one is measured.
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
