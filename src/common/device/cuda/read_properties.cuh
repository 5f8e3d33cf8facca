// What CUDA tells of a device, and what a plan takes of it.
#pragma once

#include <cuda_runtime_api.h>

#include "common/plan/render_properties.h"

namespace pt {

inline DeviceProperties plan_properties(const cudaDeviceProp& device) {
  DeviceProperties result;
  result.is_cuda = true;
  result.block_shared_bytes = device.sharedMemPerBlockOptin;
  result.block_threads_max = device.maxThreadsPerBlock;
  return result;
}

}  // namespace pt
