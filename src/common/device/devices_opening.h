// The contexts of GPUs, which take longer to create than many scenes to load.
#pragma once

#include <thread>
#include <vector>

#include "common/device/devices.h"

namespace pt {

/// Creates the contexts of those devices that are GPUs while the host does something else. Whoever
/// uses such a device waits for its context. What fails here fails there again, where it is said.
class DeviceOpening {
 public:
  explicit DeviceOpening(const std::vector<DeviceInfo>& devices);

 private:
  std::vector<std::jthread> threads_;
};

}  // namespace pt
