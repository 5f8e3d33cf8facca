// Times of kernels in the default stream.
#pragma once

#include <array>

#include "common/cuda/cuda_check.cuh"

namespace pt::device_build {

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
