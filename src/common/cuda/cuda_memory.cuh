// Device memory by name: allocated once, reported by size, freed with its owner.
#pragma once

#include <cuda_runtime_api.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/options/stats.h"

namespace pt {

// Large copies between a GPU and memory that is not pinned, by way of pieces of pinned memory:
// threads fill or empty some while the device copies others. CUDA's own copy does the same by one
// thread.

class CudaUpload {
 public:
  CudaUpload() = default;
  CudaUpload(const CudaUpload&) = delete;
  CudaUpload& operator=(const CudaUpload&) = delete;
  ~CudaUpload();

  /// To the current device, the same one each time; complete when it returns. Throws Error.
  void copy(void* to, const void* from, std::uint64_t size_bytes);

 private:
  /// What one thread works with.
  struct Lane {
    cudaStream_t stream = nullptr;
    char* pieces[2] = {};
    cudaEvent_t copied[2] = {};
  };

  void allocate();
  void copy_every(int lane, char* to, const char* from, std::uint64_t size_bytes);

  static constexpr int lanes = 4;
  Lane lanes_[lanes];
  int device_ = 0;
};

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
  void copy_to_device(void* device, const void* host, std::uint64_t size_bytes);

  std::vector<void*> pointers_;
  std::unique_ptr<CudaUpload> upload_;  ///< once there was a large array
  std::vector<BufferSize> sizes_;
};

}  // namespace pt
