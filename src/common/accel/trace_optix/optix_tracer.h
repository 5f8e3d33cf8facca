// OptiX as the tracer of a renderer: its structure over the scene's triangles, and programs.
#pragma once

#include "common/accel/trace_optix/optix_pipeline.h"
#include "common/accel/trace_optix/optix_structure.h"
#include "common/options/stats.h"

namespace pt {

class OptixTracer {
 public:
  /// Builds both. `scene`: a Scene, on the device; it and `memory` must outlive the tracer. Throws
  /// Error.
  template <class Scene>
  OptixTracer(OptixMemory& memory, const Scene& scene, OptixHits hits, const OptixModule& module)
      : context_(std::make_shared<const OptixLibrary>()),
        structure_(context_, memory, scene.triangles, hits, scene.primitives),
        pipeline_(context_, memory, module, hits, structure_.content()) {}

  /// Enqueues `width` threads; `params` has what the module's programs are launched with.
  void launch(OptixPipeline::Launch kind, const void* params, std::uint32_t width) {
    pipeline_.launch(kind, params, width);
  }

  template <class Scene>
  OptixScene scene(const Scene& scene) const {
    return optix_scene(scene.triangles, structure_, scene.primitives, scene.bvh_nodes);
  }

  /// `reorders`: the programs ask for it.
  void describe(RenderReport& report, bool reorders) const {
    report.accel = "optix";
    report.optix = {structure_.build_ms(), structure_.bytes_built(), structure_.bytes_compacted(),
                    context_.rtcore_version(), reorders && context_.reorders()};
    report.memory.push_back({"OptiX's structures", structure_.bytes_compacted()});
  }

 private:
  OptixContext context_;
  OptixStructure structure_;
  OptixPipeline pipeline_;
};

}  // namespace pt
