#include "common/device/devices_opening.h"

namespace pt {

DeviceOpening::DeviceOpening([[maybe_unused]] const std::vector<DeviceInfo>& devices) {
#ifdef PTEXP_CUDA
  for (const DeviceInfo& device : devices) {
    if (device.choice.kind != DeviceChoice::Kind::cuda) continue;
    threads_.emplace_back([index = device.choice.index] { open_cuda_device(index); });
  }
#endif
}

}  // namespace pt
