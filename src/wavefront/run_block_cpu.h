// The stages that trace, over blocks of slots: the rays of a block are traced together
// (transport/intersect_block.h), then the stage finishes each slot as it does alone. Compiled once,
// apart from the stages that are made for each kind of scene.
#pragma once

#include "common/transport/intersect_block.h"
#include "wavefront/wave_buffers.h"

namespace pt {

/// As run_stage_cpu. `traits` are those of the rays, `samples` names their paths.
void run_blocks_cpu(const PathRays& stage, const BlockTraits& traits, const SampleBuffer& samples,
                    const Scene& scene, const StageQueues& queues);
void run_blocks_cpu(const ShadowRays& stage, const BlockTraits& traits, const SampleBuffer& samples,
                    const Scene& scene, const StageQueues& queues);

/// Whether the stage traces rays, which some structures trace in blocks.
template <class Stage>
inline constexpr bool may_run_in_blocks = false;
template <class Traits>
inline constexpr bool may_run_in_blocks<IntersectRays<Traits>> = !Traits::has_motion;
template <class Traits>
inline constexpr bool may_run_in_blocks<TraceShadowRays<Traits>> = !Traits::has_motion;

/// The traits of its rays.
template <template <class> class Stage, class Traits>
BlockTraits block_traits(const Stage<Traits>&, const Scene& scene) {
  const bool is_any = Traits::accel == Accel::any;
  return {is_any ? scene.triangles.accel : Traits::accel, Traits::geometry, Traits::has_masks,
          Traits::has_media};
}

}  // namespace pt
