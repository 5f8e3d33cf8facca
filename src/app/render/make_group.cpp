#include "app/render/make_group.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "app/render/make_renderer.h"
#include "common/device/cpu/cpu_renderer.h"
#include "common/error/error.h"
#include "common/options/option_names.h"

namespace pt {
namespace {

// A wavefront's pool and a GPU's threads are full for some milliseconds (results/).
constexpr std::uint64_t least_paths_cuda = std::uint64_t{1} << 22;
constexpr std::uint64_t least_paths_per_thread = std::uint64_t{1} << 12;

std::uint64_t least_paths(const DeviceInfo& device) {
  if (device.choice.kind == DeviceChoice::Kind::cuda) return least_paths_cuda;
  return least_paths_per_thread * static_cast<std::uint64_t>(device.properties.threads);
}

std::string name_of(const DeviceInfo& device) {
  const std::string kind = to_string(device.choice.kind);
  return fmt::format("{}:{}", kind, device.choice.index);
}

}  // namespace

bool needs_group(const Options& options, const std::vector<DeviceInfo>& devices) {
  const bool is_divided = std::getenv(units_variable) != nullptr;
  return devices.size() > 1 || !options.checkpoint.file.empty() || options.part.count > 1 ||
         is_divided;
}

std::vector<std::unique_ptr<Worker>> make_workers(const std::vector<ExecutionPlan>& plans,
                                                  const SceneData& scene,
                                                  const std::vector<DeviceInfo>& devices,
                                                  ResultBell& bell) {
  std::vector<std::unique_ptr<Worker>> workers;
  std::vector<LocalWorker*> locals;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    const DeviceInfo& device = devices[i];
    const auto make = [plan = plans[i], &scene, device](int halvings) {
      ExecutionPlan own = plan;
      own.memory_halvings = halvings;
      return make_renderer(own, scene, device);
    };
    auto worker = std::make_unique<LocalWorker>(name_of(device), least_paths(device), make, bell);
    locals.push_back(worker.get());
    workers.push_back(std::move(worker));
  }
  for (LocalWorker* worker : locals) worker->wait_until_ready();
  return workers;
}

std::vector<Window> part_windows(const Options& options) {
  const Window image = window_of(options);
  const PartChoice& part = options.part;
  if (part.count == 1) return {image};
  const auto count = static_cast<std::uint32_t>(part.count);
  if (count > image.height) {
    throw Error(fmt::format("--part {}/{}: the image has {} rows; expected at most as many parts",
                            part.index, part.count, image.height));
  }
  constexpr std::uint32_t stripes_per_part = 8;
  const std::uint32_t rows = std::max(1u, image.height / (stripes_per_part * count));
  std::vector<Window> windows;
  for (std::uint32_t y = 0, stripe = 0; y < image.height; y += rows, ++stripe) {
    if (stripe % count + 1 != static_cast<std::uint32_t>(part.index)) continue;
    windows.push_back({image.x, image.y + y, image.width, std::min(rows, image.height - y)});
  }
  return windows;
}

}  // namespace pt
