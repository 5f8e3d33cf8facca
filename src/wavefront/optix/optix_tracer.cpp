#include "wavefront/optix/optix_tracer.h"

#include <algorithm>

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

OptixTracer::OptixTracer(OptixMemory& memory, const Scene& scene, bool has_masks, OptixHits hits,
                         const std::string& code)
    : has_masks_(has_masks),
      context_(std::make_shared<const OptixLibrary>()),
      structure_(context_, memory, scene.triangles, hits),
      pipeline_(context_, memory, code, hits, sizeof(OptixQueueParams),
                scene.triangles.instance_count > 0) {}

void OptixTracer::launch(OptixPipeline::Launch kind, const Scene& scene, const PathPool& pool,
                         const OptixQueue& queue, const SampleBuffer& samples) {
  const OptixQueueParams params{.scene = optix_scene(scene.triangles, structure_),
                                .world = scene,
                                .has_masks = has_masks_,
                                .pool = pool,
                                .slots = queue.slots,
                                .count = queue.count,
                                .samples = samples};
  pipeline_.launch(kind, &params, std::min(pool.slot_count, optix_width_max));
}

OptixFacts OptixTracer::facts() const {
  return {structure_.build_ms(), structure_.bytes_built(), structure_.bytes_compacted(),
          context_.rtcore_version()};
}

}  // namespace pt
