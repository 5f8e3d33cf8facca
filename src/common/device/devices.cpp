#include "common/device/devices.h"

#include <fmt/format.h>

#include "common/device/cpu/cpu_renderer.h"
#include "common/error/error.h"

namespace pt {
namespace {

struct Devices {
  std::vector<DeviceInfo> list;
  std::string about_gpus;  ///< why there are no more
};

Devices find_devices() {
  const int threads = cpu_threads(0);
  Devices devices;
  devices.list.push_back({{DeviceChoice::Kind::cpu, 0},
                          "CPU",
                          fmt::format("{} thread{}", threads, threads == 1 ? "" : "s"),
                          cpu_properties(threads)});
#ifdef PTEXP_CUDA
  devices.about_gpus = append_cuda_devices(devices.list);
#else
  devices.about_gpus = "this ptexp was built without CUDA";
#endif
  return devices;
}

}  // namespace

std::vector<DeviceInfo> list_devices() { return find_devices().list; }

DeviceInfo choose_device(const DeviceChoice& choice) {
  const auto [devices, about_gpus] = find_devices();
  if (choice.kind == DeviceChoice::Kind::cpu) return devices.front();
  if (choice.kind == DeviceChoice::Kind::automatic) {
    return devices.size() > 1 ? devices[1] : devices.front();
  }
  for (const DeviceInfo& device : devices) {
    if (device.choice.kind == DeviceChoice::Kind::cuda && device.choice.index == choice.index) {
      return device;
    }
  }
  throw Error(fmt::format("--device cuda:{}: no such CUDA device; {}", choice.index, about_gpus));
}

}  // namespace pt
