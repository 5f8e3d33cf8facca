#include <cuda_runtime_api.h>
#include <fmt/format.h>

#include "common/device/devices.h"

namespace pt {

std::string append_cuda_devices(std::vector<DeviceInfo>& devices) {
  int count = 0;
  const cudaError_t status = cudaGetDeviceCount(&count);
  if (status != cudaSuccess) {
    cudaGetLastError();  // clears it
    return fmt::format("CUDA says: {}", cudaGetErrorString(status));
  }
  int driver = 0;
  if (cudaDriverGetVersion(&driver) != cudaSuccess) cudaGetLastError();  // clears it
  for (int i = 0; i < count; ++i) {
    cudaDeviceProp p{};
    if (cudaGetDeviceProperties(&p, i) != cudaSuccess) continue;
    DeviceInfo device;
    device.choice.kind = DeviceChoice::Kind::cuda, device.choice.index = i;
    device.name = p.name;
    device.detail = fmt::format(
        "{} multiprocessors, {:.1f} GiB, compute capability {}.{}", p.multiProcessorCount,
        static_cast<double>(p.totalGlobalMem) / (1 << 30), p.major, p.minor);
    device.driver = fmt::format("CUDA {}.{}", driver / 1000, driver % 1000 / 10);
    device.properties.is_cuda = true;
    device.properties.block_shared_bytes = p.sharedMemPerBlockOptin;
    device.properties.block_threads_max = p.maxThreadsPerBlock;
    device.properties.multiprocessors = p.multiProcessorCount;
    const int capability = 10 * p.major + p.minor;  // 10.x: Blackwell without RT cores
    device.properties.can_reorder = capability == 89 || capability >= 120;
    devices.push_back(device);
  }
  return fmt::format("this machine has {}", count);
}

void open_cuda_device(int index) {
  if (cudaSetDevice(index) != cudaSuccess) cudaGetLastError();  // clears it
}

}  // namespace pt
