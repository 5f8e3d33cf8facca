#include "common/device/devices.h"

#include <fmt/format.h>

#include <algorithm>

#include "common/device/cpu/cpu_renderer.h"
#include "common/error/error.h"
#include "common/options/option_names.h"
#include "common/plan/plan_steps.h"

namespace pt {
namespace {

struct Devices {
  std::vector<DeviceInfo> list;
  std::string about_gpus;  ///< why there are no more
};

void set_threads(DeviceInfo& cpu, int threads) {
  cpu.detail = fmt::format("{} thread{}", threads, threads == 1 ? "" : "s");
  cpu.properties = cpu_properties(threads);
}

Devices find_devices() {
  Devices devices;
  DeviceInfo cpu;
  cpu.choice.kind = DeviceChoice::Kind::cpu;
  cpu.name = "CPU";
  set_threads(cpu, cpu_threads(0));
  devices.list.push_back(cpu);
#ifdef PTEXP_CUDA
  // Which GPUs a process sees never changes, and asking takes a millisecond for each.
  static const Devices gpus = [] {
    Devices found;
    found.about_gpus = append_cuda_devices(found.list);
    return found;
  }();
  devices.list.insert(devices.list.end(), gpus.list.begin(), gpus.list.end());
  devices.about_gpus = gpus.about_gpus;
#else
  devices.about_gpus = "this ptexp was built without CUDA";
#endif
  return devices;
}

}  // namespace

std::vector<DeviceInfo> list_devices() { return find_devices().list; }

std::vector<DeviceInfo> choose_devices(const DeviceChoice& choice, int threads) {
  using Kind = DeviceChoice::Kind;
  std::vector<DeviceInfo> chosen;
  if (choice.wants_all) {
    for (const DeviceInfo& device : list_devices()) {
      if (device.choice.kind == Kind::cuda) chosen.push_back(device);
    }
    if (chosen.empty()) choose_device({Kind::cuda, 0});  // says why there is none
    return chosen;
  }
  chosen.push_back(choose_device({choice.kind, choice.index}));
  for (const int index : choice.more) chosen.push_back(choose_device({choice.kind, index}));
  if (chosen.front().choice.kind != Kind::cpu) return chosen;
  const int share = std::max(1, cpu_threads(threads) / static_cast<int>(chosen.size()));
  int index = 0;
  for (DeviceInfo& device : chosen) {
    device.choice.index = index++;
    set_threads(device, share);
  }
  return chosen;
}

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

DeviceInfo limited(DeviceInfo device, const DeviceLimits& limits) {
  if (limits.sms > 0 && !device.properties.is_cuda)
    throw Error(fmt::format("--sms {}: has no effect on the device {}; it applies to cuda",
                            limits.sms, to_string(device.choice.kind)));
  const int all = device.properties.multiprocessors;
  device.properties = limit_device(device.properties, limits);
  device.sms = limits.sms;
  if (limits.sms > 0 && limits.sms < all)
    device.name += fmt::format(", {} of {} multiprocessors", limits.sms, all);
  return device;
}

DeviceOpening::DeviceOpening([[maybe_unused]] const std::vector<DeviceInfo>& devices) {
#ifdef PTEXP_CUDA
  for (const DeviceInfo& device : devices) {
    if (device.choice.kind != DeviceChoice::Kind::cuda) continue;
    threads_.emplace_back([index = device.choice.index] { open_cuda_device(index); });
  }
#endif
}

}  // namespace pt
