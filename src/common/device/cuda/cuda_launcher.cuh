// Kernel launches of a renderer: on a stream, inside NVTX ranges, with their resources noted, timed
// by events, and counted by the hardware where that is asked for.
#pragma once

#include <cuda_runtime_api.h>
#include <nvtx3/nvToolsExt.h>

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "common/cuda/cuda_check.cuh"
#include "common/cuda/used_gpu.cuh"
#include "common/device/cuda/counter_session_cuda.h"
#include "common/device/cuda/stage_clock.h"
#include "common/options/options.h"
#include "common/render/renderer.h"

namespace pt {

/// A range of the host's time line in Nsight Systems (NVTX), as long as it lives. Ranges nest; the
/// kernels launched in one are shown as its own.
class ProfilerRange {
 public:
  explicit ProfilerRange(const char* name) { nvtxRangePushA(name); }
  explicit ProfilerRange(const std::string& name) : ProfilerRange(name.c_str()) {}
  ~ProfilerRange() { nvtxRangePop(); }
  ProfilerRange(const ProfilerRange&) = delete;
  ProfilerRange& operator=(const ProfilerRange&) = delete;
};

class CudaLauncher {
 public:
  /// Makes `device`, as far as the limits let it, the thread's device. Throws Error where it is not
  /// there.
  CudaLauncher(int device, const DeviceLimits& limits);
  ~CudaLauncher();
  CudaLauncher(const CudaLauncher&) = delete;
  CudaLauncher& operator=(const CudaLauncher&) = delete;

 protected:
  /// Launches a kernel on stream() inside an NVTX range of its name and notes its resources.
  /// Throws Error when the device cannot run a block of this size.
  template <class... Parameters, class... Arguments>
  void launch(const char* name, void (*kernel)(Parameters...), dim3 grid, dim3 block,
              std::size_t shared_bytes, const Arguments&... arguments) {
    launch_erased(name, reinterpret_cast<const void*>(kernel), grid, block, shared_bytes,
                  Pack<Parameters...>(arguments...).pointers());
  }

  /// The same with a thread for each of `count`.
  template <class... Parameters, class... Arguments>
  void launch_each(const char* name, void (*kernel)(Parameters...), std::uint32_t count,
                   const Arguments&... arguments) {
    constexpr std::uint32_t block = 256;
    launch(name, kernel, (count + block - 1) / block, block, 0, arguments...);
  }

  /// Calls `enqueue`, which launches a library's kernels on stream(), as many in each call of one
  /// kind; they are counted under this name.
  void launch_others(const char* name, int kind, const std::function<void()>& enqueue);

  /// Blocks of `kernel` that the device holds at once.
  std::uint32_t resident_blocks(const void* kernel, int block_threads, std::size_t shared_bytes);

  /// Calls `enqueue` between two readings of the clocks, waits for what it enqueued, and adds its
  /// time to `run`.
  void time_batch(RenderRun& run, const std::function<void()>& enqueue);

  /// Makes the hardware's counters those of the launches in `work`, which may run several times.
  HardwareCounters count_launches(const std::function<void()>& work);
  /// Whether the hardware's counters are read: every kernel is then launched by the host.
  bool is_counting() const { return counters_ != nullptr; }
  /// What follows belongs to this wave; -1: to none.
  void set_wave(int wave) { wave_ = wave; }

  /// What a thread does before it uses the device.
  void use_device() const { device_.use(); }
  int device() const { return device_.index(); }
  /// ", 16 of 132 multiprocessors" of a part of a GPU, else empty.
  std::string part_text() const { return device_.part_text(); }
  cudaStream_t stream() const { return stream_; }
  /// In the device's memory, where stages note their times.
  StageClock* clock() const { return clock_; }
  void set_clock(StageClock* clock) { clock_ = clock; }
  void reset_clock();
  /// What runs next is this stage, whose launches read no clock.
  void enqueue_stamp(StageId stage);
  void read_clock(RenderRun& run) const;
  /// What was launched so far.
  const std::vector<KernelInfo>& kernels() const { return kernels_; }
  /// The time that the device's context and the stream took to make.
  double opening_ms() const { return opening_ms_; }

  const cudaDeviceProp properties_;  ///< within the limits

 private:
  friend class BlockWavefronts;  // another user of the launches

  /// The arguments of a launch, converted to the kernel's parameters and listed by address.
  template <class... Parameters>
  class Pack {
   public:
    template <class... Arguments>
    explicit Pack(const Arguments&... arguments) : values_(arguments...) {}
    void** pointers() {
      std::apply(
          [this](auto&... value) {
            pointers_ = {const_cast<void*>(static_cast<const void*>(&value))...};
          },
          values_);
      return pointers_.data();
    }

   private:
    std::tuple<std::remove_cv_t<Parameters>...> values_;
    std::array<void*, sizeof...(Parameters)> pointers_{};
  };

  int count_kernels(const std::function<void()>& enqueue) const;
  void launch_erased(const char* name, const void* kernel, dim3 grid, dim3 block,
                     std::size_t shared_bytes, void** arguments);
  void note_kernel(const char* name, const void* kernel, dim3 block, std::size_t shared_bytes);

  UsedGpu device_;
  double opening_ms_ = 0;
  cudaStream_t stream_ = nullptr;
  cudaEvent_t start_ = nullptr, stop_ = nullptr;
  StageClock* clock_ = nullptr;
  std::unique_ptr<CounterSession> counters_;           ///< while they are read
  std::map<std::pair<std::string, int>, int> others_;  ///< kernels of launch_others, by its call
  int wave_ = -1;
  std::vector<KernelInfo> kernels_;
  /// The names of kernels; one kernel may run as several stages.
  std::vector<std::pair<const void*, std::string>> noted_kernels_;
};

}  // namespace pt
