// A GPU's memory and stream for OptiX.
#pragma once

#include <cuda_runtime_api.h>

#include "common/accel/trace_optix/optix_memory.h"

namespace pt {

class CudaOptixMemory : public OptixMemory {
 public:
  /// On the current device.
  explicit CudaOptixMemory(cudaStream_t stream) : stream_(stream) {}

  void* allocate(std::size_t bytes, const char* what) override;
  void release(void* memory) noexcept override;
  void to_device(void* to, const void* from, std::size_t bytes) override;
  void to_host(void* to, const void* from, std::size_t bytes) override;
  void enqueue_to_device(void* to, const void* from, std::size_t bytes) override;
  void synchronize() override;
  optix::Stream stream() const override { return stream_; }
  void enqueue_boxes(optix::Box* boxes, const Triangle* triangles, std::size_t count,
                     const OptixBoxMargin& margin) override;

 private:
  cudaStream_t stream_;
};

}  // namespace pt
