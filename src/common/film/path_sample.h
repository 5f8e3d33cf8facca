// The sink (transport/path_step.h) of a path that is about to end.
#pragma once

#include "common/film/film.h"

namespace pt {

/// Puts the path's radiance into its sample.
struct PathSample {
  const SampleBuffer& samples;
  Color radiance;  ///< of the path so far

  PT_HD void emit(const PathState&, const Color& emitted) {
    radiance = add_rounded(radiance, emitted);
  }
  PT_HD void end(const PathState& path) { samples.store(path, radiance); }
};

}  // namespace pt
