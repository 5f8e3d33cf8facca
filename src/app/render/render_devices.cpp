#include "app/render/render_devices.h"

#include "app/render/rank_setup.h"

namespace pt {

std::vector<DeviceInfo> choose_render_devices(Options& options, const GivenOptions& given,
                                              const Ranks* ranks) {
  using Kind = DeviceChoice::Kind;
  if (options.mode == Mode::serial) options.device = {Kind::cpu, 0};  // one CPU thread, GPU or not
  const bool is_shared = ranks != nullptr && ranks->count() > 1;
  const std::vector<DeviceInfo> devices = is_shared
                                              ? choose_rank_devices(options, ranks->own())
                                              : choose_devices(options.device, options.threads);
  check_applicable(options, given, devices.front().choice.kind);
  options.device = devices.front().choice;
  for (std::size_t i = 1; i < devices.size(); ++i) {
    options.device.more.push_back(devices[i].choice.index);
  }
  return devices;
}

}  // namespace pt
