// Built instead of optix_code.cpp where CMake makes no modules for OptiX (PTEXP_OPTIX).
#include "common/accel/trace_optix/optix_rays.h"

namespace pt {

const std::string& optix_ray_code() {
  static const std::string none;
  return none;
}

}  // namespace pt
