// Large copies from a GPU into memory that is not pinned.
#pragma once

#include <cuda_runtime_api.h>

#include <cstdint>

namespace pt {

/// Two pieces of pinned memory: one is filled by the device while threads empty the other. CUDA's
/// own copy into such memory does so, too, by one thread.
class CudaDownload {
 public:
  CudaDownload() = default;
  CudaDownload(const CudaDownload&) = delete;
  CudaDownload& operator=(const CudaDownload&) = delete;
  ~CudaDownload();

  /// After what `stream` has been given before; complete when it returns. Throws Error.
  void copy(void* to, const void* from, std::uint64_t size_bytes, cudaStream_t stream);

 private:
  void allocate();

  char* pieces_[2] = {};
  cudaEvent_t filled_[2] = {};
};

}  // namespace pt
