#include "app/report/origin_columns.h"

#include <fstream>

#include "common/platform/build_info.h"

namespace pt {
namespace {

/// Of the kernel module; empty where there is none.
std::string driver_version() {
  std::ifstream file("/sys/module/nvidia/version");
  std::string version;
  std::getline(file, version);
  return version;
}

}  // namespace

CsvRow origin_columns(const std::string& command_line, const DeviceInfo& device, int threads) {
  const bool is_cuda = device.choice.kind == DeviceChoice::Kind::cuda;
  const BuildInfo& build = build_info();
  return {{"version", build.version},
          {"commit", build.commit},
          {"build_type", build.build_type},
          {"compiler", build.compiler},
          {"cuda", build.cuda},
          {"fast_math", build.fast_math ? "on" : "off"},
          {"command", command_line},
          {"device", device.name},
          {"device_kind", is_cuda ? "cuda" : "cpu"},
          {"threads", is_cuda ? "" : std::to_string(threads)},
          {"driver", is_cuda ? driver_version() : ""}};
}

}  // namespace pt
