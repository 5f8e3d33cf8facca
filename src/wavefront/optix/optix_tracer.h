// OptiX as the tracer of the wavefront's queues.
#pragma once

#include <string>

#include "common/accel/trace_optix/optix_pipeline.h"
#include "common/accel/trace_optix/optix_structure.h"
#include "common/options/stats.h"
#include "wavefront/optix/optix_queue.h"

namespace pt {

/// optix_queue_programs.cu in PTX; empty where ptexp was built without it.
const std::string& optix_queue_code();

/// A queue of slots in the device's memory: the first *count of them.
struct OptixQueue {
  const std::uint32_t* slots;
  const std::uint32_t* count;
};

class OptixTracer {
 public:
  /// Builds the structures and the programs. `scene`: on the device; `memory` must outlive the
  /// tracer, and the scene's triangles and instances too. Throws Error.
  OptixTracer(OptixMemory& memory, const Scene& scene, bool has_masks, OptixHits hits,
              const std::string& code);

  /// Enqueue launches over a queue: the next hit of each path is stored; light that arrives is
  /// added.
  void trace_queue(const Scene& scene, const PathPool& pool, const OptixQueue& queue,
                   const SampleBuffer& samples) {
    launch(OptixPipeline::closest, scene, pool, queue, samples);
  }
  void trace_shadow_queue(const Scene& scene, const PathPool& pool, const OptixQueue& queue,
                          const SampleBuffer& samples) {
    launch(OptixPipeline::any, scene, pool, queue, samples);
  }

  OptixFacts facts() const;

 private:
  void launch(OptixPipeline::Launch kind, const Scene& scene, const PathPool& pool,
              const OptixQueue& queue, const SampleBuffer& samples);

  bool has_masks_;
  OptixContext context_;
  OptixStructure structure_;
  OptixPipeline pipeline_;
};

}  // namespace pt
