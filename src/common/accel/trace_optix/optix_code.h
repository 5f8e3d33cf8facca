// The programs for OptiX in PTX; empty where ptexp was built without them.
#pragma once

#include <string>

namespace pt {

/// optix_ray_programs.cu, with OptixRayParams.
const std::string& optix_ray_code();

}  // namespace pt
