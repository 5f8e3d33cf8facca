// What a build on the device needs besides the tree: temporary memory, and times of its kernels.
#pragma once

#include <cuda_runtime_api.h>
#include <fmt/format.h>

#include <array>
#include <cstdint>

#include "common/cuda/cuda_check.cuh"
#include "common/error/error.h"

namespace pt::device_build {

/// Device memory that grows when needed and is divided again by each build.
class Scratch {
 public:
  Scratch() = default;
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() { release(); }

  void release();

  /// The layout is asked for twice: first to measure (null pointers), then to divide.
  template <class Layout>
  void divide(Layout&& layout) {
    used_ = 0;
    measures_ = true;
    layout(*this);
    const std::uint64_t needed = used_;
    if (needed > capacity_) reserve(needed);
    used_ = 0;
    measures_ = false;
    layout(*this);
  }

  std::uint64_t size_bytes() const { return capacity_; }

  template <class T>
  T* take(std::uint64_t count) {
    constexpr std::uint64_t alignment = 256;
    const std::uint64_t begin = used_;
    used_ += (count * sizeof(T) + alignment - 1) / alignment * alignment;
    return measures_ ? nullptr : reinterpret_cast<T*>(static_cast<char*>(memory_) + begin);
  }

 private:
  void reserve(std::uint64_t size_bytes);

  void* memory_ = nullptr;
  std::uint64_t capacity_ = 0, used_ = 0;
  bool measures_ = false;
};

inline void Scratch::release() {
  cudaFree(memory_);
  memory_ = nullptr;
  capacity_ = 0;
}

inline void Scratch::reserve(std::uint64_t size_bytes) {
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

/// Times between marks in the default stream.
class Stopwatch {
 public:
  Stopwatch() {
    for (cudaEvent_t& event : events_) check_cuda(cudaEventCreate(&event), "cudaEventCreate");
  }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  ~Stopwatch() {
    for (const cudaEvent_t event : events_) cudaEventDestroy(event);
  }

  void start() { next_ = 0, mark(nullptr); }
  /// The time since the last mark is added to *time once read() is called; null: it is dropped.
  void mark(float* time_ms) {
    check_cuda(cudaEventRecord(events_.at(next_)), "cudaEventRecord");
    times_[next_++] = time_ms;
  }
  void read() {
    check_cuda(cudaEventSynchronize(events_[next_ - 1]), "building a tree");
    for (std::size_t i = 1; i < next_; ++i) {
      float elapsed = 0;
      check_cuda(cudaEventElapsedTime(&elapsed, events_[i - 1], events_[i]), "elapsed time");
      if (times_[i] != nullptr) *times_[i] += elapsed;
    }
    start();
  }

 private:
  std::array<cudaEvent_t, 16> events_{};
  std::array<float*, 16> times_{};
  std::size_t next_ = 0;
};

}  // namespace pt::device_build
