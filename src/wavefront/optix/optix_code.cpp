// The module for OptiX, compiled to PTX by CMakeLists.txt.
#include "wavefront/optix/optix_tracer.h"

namespace pt {
namespace {

constexpr char queue_code[] =
#include <optix/optix_queue_programs.inc>
    ;

}  // namespace

const std::string& optix_queue_code() {
  static const std::string code = queue_code;
  return code;
}

}  // namespace pt
