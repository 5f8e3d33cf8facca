// What the stages of a wave have to move by the layout of their data: each record of the path pool,
// each entry of a queue and each sample that a stage reads or writes, once. The scene, random
// states and the film are not among it. The hardware moves more where a warp's slots are not side
// by side, for it moves sectors of 32 bytes, and where two instructions write the halves of a
// sector (a ray in the layout `sectors`), which L1 merges in part. results/ has the comparison.
#pragma once

#include <string>

#include "common/film/film.h"
#include "common/options/hardware_counters.h"
#include "wavefront/pool/path_pool.h"
#include "wavefront/pool/wave_counters.h"

namespace pt {

/// How many slots took which way in one wave.
struct WaveFlow {
  double generated = 0;  ///< new paths
  double rays = 0;       ///< all paths in flight, the new ones included
  double misses = 0, surfaces = 0;
  double shadows = 0;    ///< surfaces that sampled a light
  double continued = 0;  ///< paths that are in flight in the next wave
  double finished = 0;   ///< paths that were followed to their ends after it
};

/// The flow of a wave by its counters; begin_wave of the next wave tells `continued`.
WaveFlow flow_of(const WaveCounters& counters);

/// What of the render the bytes depend on.
struct WaveLayout {
  PathPool::Fields fields;
  double slots = 0;          ///< of the pool
  bool has_queues = true;    ///< else stages look at the tags of all slots
  bool appends = true;       ///< stages append to queues, else they write tags
  bool queues_free = false;  ///< free slots are queued
  bool all_lights = false;   ///< Lighting::full: a miss needs the whole ray
  bool fused = false;        ///< one kernel traces and shades: fields.lights concerns samples alone
  bool persistent = false;   ///< persistent warps trace the rays, and route_hits sends them on
};

/// The bytes of one launch in a wave of this flow; nothing for kernels that are no stages. `kernel`
/// as the statistics name it: "intersect", "shade_surface". A path is as likely to be new among
/// misses as among surfaces, and each sampled light contributes.
PredictedBytes predict_bytes(const std::string& kernel, const WaveFlow& flow,
                             const WaveLayout& layout);

}  // namespace pt
