// The first columns of a subcommand's CSV: program, command and device.
#pragma once

#include <string>

#include "app/report/report.h"
#include "common/device/devices.h"

namespace pt {

/// `threads`: of the CPU.
CsvRow origin_columns(const std::string& command_line, const DeviceInfo& device, int threads);

}  // namespace pt
