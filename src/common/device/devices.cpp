#include "common/device/devices.h"

#include <fmt/format.h>

#include <thread>

#include "common/error.h"

#ifdef PTEXP_CUDA
#include <cuda_runtime_api.h>
#endif

namespace pt {
namespace {

std::string no_gpu_reason = "this ptexp was built without CUDA";

void add_cuda_devices(std::vector<DeviceInfo>& devices) {
#ifdef PTEXP_CUDA
  int count = 0;
  const cudaError_t status = cudaGetDeviceCount(&count);
  if (status != cudaSuccess) {
    no_gpu_reason = fmt::format("CUDA says: {}", cudaGetErrorString(status));
    cudaGetLastError();  // clears it
    return;
  }
  no_gpu_reason = fmt::format("this machine has {}", count);
  for (int i = 0; i < count; ++i) {
    cudaDeviceProp p{};
    if (cudaGetDeviceProperties(&p, i) != cudaSuccess) continue;
    devices.push_back(
        {{DeviceChoice::Kind::cuda, i},
         p.name,
         fmt::format("{} multiprocessors, {:.1f} GiB, compute capability {}.{}",
                     p.multiProcessorCount, static_cast<double>(p.totalGlobalMem) / (1 << 30),
                     p.major, p.minor)});
  }
#else
  (void)devices;
#endif
}

}  // namespace

std::vector<DeviceInfo> list_devices() {
  const unsigned threads = std::thread::hardware_concurrency();
  std::vector<DeviceInfo> devices = {
      {{DeviceChoice::Kind::cpu, 0}, "CPU", fmt::format("{} threads", threads)}};
  add_cuda_devices(devices);
  return devices;
}

DeviceInfo choose_device(const DeviceChoice& choice) {
  const std::vector<DeviceInfo> devices = list_devices();
  if (choice.kind == DeviceChoice::Kind::cpu) return devices.front();
  if (choice.kind == DeviceChoice::Kind::automatic) {
    return devices.size() > 1 ? devices[1] : devices.front();
  }
  for (const DeviceInfo& device : devices) {
    if (device.choice.kind == DeviceChoice::Kind::cuda && device.choice.index == choice.index) {
      return device;
    }
  }
  throw Error(
      fmt::format("--device cuda:{}: no such CUDA device; {}", choice.index, no_gpu_reason));
}

}  // namespace pt
