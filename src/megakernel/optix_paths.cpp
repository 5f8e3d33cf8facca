#include "megakernel/optix_paths.h"

#include <algorithm>

#include "common/accel/trace_optix/optix_tracer.h"

namespace pt {
namespace {

constexpr unsigned char path_code[] = {
#include <optix/optix_path_programs.inc>
};

}  // namespace

OptixModule optix_path_module(const OptixPathChoices& choices) {
  static const std::string code = unpack_optix_code(path_code);
  return {code,
          sizeof(OptixPathParams),
          {"__raygen__paths"},
          {reinterpret_cast<const char*>(&choices), sizeof choices}};
}

void launch_paths(OptixTracer& tracer, Work work, OptixPathParams params) {
  params.scene = tracer.scene(params.world);
  const std::uint32_t paths = params.samples.path_count;
  const std::uint32_t width = work == Work::pixel    ? params.samples.pixel_count.divisor()
                              : work == Work::sample ? paths
                                                     : std::min(paths, optix_width_max);
  tracer.launch(OptixPipeline::paths, &params, width);
}

}  // namespace pt
