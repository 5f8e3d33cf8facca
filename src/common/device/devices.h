// Which devices this machine has, and which of them an option names.
#pragma once

#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "common/options/options.h"
#include "common/plan/render_properties.h"

namespace pt {

struct DeviceInfo {
  DeviceChoice choice;          ///< what to pass as --device: never automatic
  std::string name;             ///< e.g. "NVIDIA H200"
  std::string detail;           ///< e.g. "132 multiprocessors, 139.8 GiB, compute capability 9.0"
  std::string driver{};         ///< of CUDA, e.g. "CUDA 13.0"; empty on the CPU
  DeviceProperties properties;  ///< what a plan depends on
  int sms = 0;                  ///< multiprocessors to use, 0: all
};

/// The CPU first, then every usable CUDA device. Never throws: a broken driver means no GPU.
std::vector<DeviceInfo> list_devices();

/// Resolves automatic to the first GPU, else the CPU. Throws Error when the device is not there,
/// saying why (no GPU found, built without CUDA, ordinal out of range).
DeviceInfo choose_device(const DeviceChoice& choice);

/// The same for a choice that may name several. Those of the CPU share `threads` (0: all).
std::vector<DeviceInfo> choose_devices(const DeviceChoice& choice, int threads);

/// As DeviceLimits have it, which its name then says. Throws Error for more than there is, and for
/// limits of a CPU.
DeviceInfo limited(DeviceInfo device, const DeviceLimits& limits);

/// Appends the usable CUDA devices; returns what to tell a user who misses one. Only in a build
/// with CUDA.
std::string append_cuda_devices(std::vector<DeviceInfo>& devices);

/// Creates the context of a CUDA device, if it can be. Only in a build with CUDA.
void open_cuda_device(int index);

/// Creates the contexts of those devices that are GPUs while the host does something else. Whoever
/// uses such a device waits for its context. What fails here fails there again, where it is said.
class DeviceOpening {
 public:
  explicit DeviceOpening(const std::vector<DeviceInfo>& devices);

 private:
  std::vector<std::jthread> threads_;
};

}  // namespace pt
