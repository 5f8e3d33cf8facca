// Whether the program's code for GPUs runs on the current device.
#pragma once

#include <cuda_runtime_api.h>

namespace pt {

/// Launches an empty kernel and waits for it.
cudaError_t run_probe_kernel();

}  // namespace pt
