// The checks of driver, GPUs, CUDA and its counters.
#pragma once

#include "app/doctor/checks.h"

namespace pt {

void add_gpu_checks(const Machine& machine, std::vector<Check>& checks);

}  // namespace pt
