// The program for OptiX in PTX; empty where ptexp was built without it.
#pragma once

#include <string>

namespace pt {

/// optix_queue_programs.cu, with OptixQueueParams.
const std::string& optix_queue_code();

}  // namespace pt
