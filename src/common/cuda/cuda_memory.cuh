// Device memory by name: allocated once, reported by size, freed with its owner.
#pragma once

#include <cuda_runtime_api.h>

#include <cstdint>
#include <string>
#include <vector>

#include "common/options/stats.h"

namespace pt {

class CudaMemory {
 public:
  CudaMemory() = default;
  CudaMemory(const CudaMemory&) = delete;
  CudaMemory& operator=(const CudaMemory&) = delete;
  ~CudaMemory();

  /// `count` uninitialised elements; null for none. Throws Error saying how much was needed and how
  /// much is free. Buffers of the same name are reported as one.
  template <class T>
  T* allocate(const std::string& name, std::uint64_t count) {
    return static_cast<T*>(allocate_bytes(name, count * sizeof(T)));
  }

  /// As allocate, filled from the host.
  template <class T>
  T* upload(const std::string& name, const std::vector<T>& values) {
    T* device = allocate<T>(name, values.size());
    copy_to_device(device, values.data(), values.size() * sizeof(T));
    return device;
  }

  const std::vector<BufferSize>& buffers() const { return sizes_; }

  /// Bytes that the current device has free.
  static std::uint64_t free_bytes();

 private:
  void* allocate_bytes(const std::string& name, std::uint64_t size_bytes);
  static void copy_to_device(void* device, const void* host, std::uint64_t size_bytes);

  std::vector<void*> pointers_;
  std::vector<BufferSize> sizes_;
};

/// Large copies from a GPU into memory that is not pinned, by way of two pieces of pinned memory:
/// the device fills one while threads empty the other. CUDA's own copy does the same by one thread.
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
