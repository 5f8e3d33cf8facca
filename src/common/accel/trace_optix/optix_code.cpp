// The modules for OptiX, compiled to PTX by CMakeLists.txt.
#include "common/accel/trace_optix/optix_rays.h"

namespace pt {
namespace {

constexpr char ray_code[] =
#include <optix/optix_ray_programs.inc>
    ;

}  // namespace

const std::string& optix_ray_code() {
  static const std::string code = ray_code;
  return code;
}

}  // namespace pt
