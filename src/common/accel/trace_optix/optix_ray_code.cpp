// The module for OptiX that traces arrays of rays, compiled to PTX by CMake (cmake/Optix.cmake).
#include "common/accel/trace_optix/optix_pipeline.h"
#include "common/accel/trace_optix/optix_rays.h"

namespace pt {
namespace {

constexpr unsigned char ray_code[] = {
#include <optix/optix_ray_programs.inc>
};

}  // namespace

const std::string& optix_ray_code() {
  static const std::string code = unpack_optix_code(ray_code);
  return code;
}

}  // namespace pt
