// Built instead of optix_code.cpp where CMake makes no modules for OptiX (PTEXP_OPTIX).
#include "wavefront/optix/optix_tracer.h"

namespace pt {

const std::string& optix_queue_code() {
  static const std::string none;
  return none;
}

}  // namespace pt
