// CUDA errors become exceptions that name the call.
#pragma once

#include <cuda_runtime_api.h>

namespace pt {

/// Throws Error("CUDA: <what>: <reason>") unless `status` is cudaSuccess: OutOfMemory where it is
/// cudaErrorMemoryAllocation.
void check_cuda(cudaError_t status, const char* what);

}  // namespace pt
