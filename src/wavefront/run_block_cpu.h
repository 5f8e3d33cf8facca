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

/// The traits of a stage's rays; only of stages that trace.
template <class Traits>
constexpr BlockTraits block_traits(const IntersectRays<Traits>&) {
  return {Traits::accel, Traits::geometry, Traits::has_masks, Traits::has_media};
}
template <class Traits>
constexpr BlockTraits block_traits(const TraceShadowRays<Traits>&) {
  return {Traits::accel, Traits::geometry, Traits::has_masks, Traits::has_media};
}

/// Whether it is a stage that traces in scenes with media.
template <class Stage>
inline constexpr bool traces_media = false;
template <class Traits>
inline constexpr bool traces_media<IntersectRays<Traits>> = Traits::has_media;
template <class Traits>
inline constexpr bool traces_media<TraceShadowRays<Traits>> = Traits::has_media;

/// Whether the stage runs so; with media where each boundary has a BSDF, so that a shadow ray ends
/// at the first surface.
template <class Stage>
inline constexpr bool runs_in_blocks = false;
template <class Traits>
inline constexpr bool runs_in_blocks<IntersectRays<Traits>> = traces_blocks<Traits>;
template <class Traits>
inline constexpr bool runs_in_blocks<TraceShadowRays<Traits>> = traces_blocks<Traits>;

}  // namespace pt
