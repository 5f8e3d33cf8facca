// The hardware counters of some launches as the reports name them: the same in JSON and CSV.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/options/hardware_counters.h"

namespace pt {

/// Name and value of each; NaN where there was nothing to divide by.
std::vector<std::pair<std::string, double>> counter_fields(const KernelCounters& kernel,
                                                           int warps_per_sm);

/// The counters of each kernel that takes time worth mentioning, as lines of the table; ends with a
/// newline.
std::string counter_rows(const HardwareCounters& counters);

}  // namespace pt
