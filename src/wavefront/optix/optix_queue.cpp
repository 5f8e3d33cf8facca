#include "wavefront/optix/optix_queue.h"

#include <algorithm>

#include "common/accel/trace_optix/optix_tracer.h"

namespace pt {
namespace {

constexpr unsigned char queue_code[] = {
#include <optix/optix_queue_programs.inc>
};

}  // namespace

OptixModule optix_queue_module() {
  static const std::string code = unpack_optix_code(queue_code);
  return {code, sizeof(OptixQueueParams)};
}

void trace_by_optix(OptixTracer& tracer, OptixPipeline::Launch kind, OptixQueueParams params) {
  params.scene = tracer.scene(params.world);
  tracer.launch(kind, &params, std::min(params.pool.slot_count, optix_width_max));
}

}  // namespace pt
