// The wavefront (Laine et al. 2013, 'Megakernels Considered Harmful'): what happens in a wave, and
// how waves follow one another, on every device. Start reading here; then wave_steps.h has the
// steps and stages.h what a stage does with one path.
#pragma once

#include "wavefront/wave_steps.h"

namespace pt {

/// One wave: free slots get new paths (unless `starts_paths` is false), and every path in flight
/// gets one more ray. `execute`: see wave_steps.h.
template <class Traits, Branching branching, class Source, class Executor>
void run_wave(Executor& execute, const WaveBuffers& b, const StageContext<Source>& context,
              bool starts_paths = true) {
  repeat_paths(execute, b, context);
  execute.compact(b.request<StageId::generate, StageId::intersect>(b.pool.tag));
  execute.begin_wave();
  const bool all_new = b.policy.fused && starts_paths && !b.reuses_slots;
  if (starts_paths && !all_new) generate_paths<Traits>(execute, b, context);
  if (b.policy.fused) return bounce_paths<Traits>(execute, b, context, all_new);

  trace_rays<Traits>(execute, b, context.samples, branching == Branching::divergent);
  sample_media<Traits>(execute, b, context.samples);
  shade_misses<Traits, branching>(execute, b, context);
  shade_surfaces<Traits, branching>(execute, b, context);
  shade_media<Traits>(execute, b, context);
  trace_shadow_rays<Traits>(execute, b, context.samples);
}

/// All waves of a batch, and the last paths. `wave(starts_paths)` runs one; a device repeats it by
/// while_waves(function) as long as begin_wave says that there is more to do.
template <class Device, class Wave, class Finish>
void run_all_waves(Device& device, const WaveBuffers& b, bool repeats, Wave&& wave,
                   Finish&& finish) {
  if (!b.reuses_slots) wave(true);  // the pool holds the whole batch: all paths start at once
  device.while_waves([&] { wave(b.reuses_slots); });
  if (!repeats) finish();
}

}  // namespace pt
