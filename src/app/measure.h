// The renders of one measurement: warm-ups, then repeats, until they are done or someone stops
// them.
#pragma once

#include <functional>
#include <vector>

#include "app/progress.h"
#include "common/render/renderer.h"

namespace pt {

struct Measurement {
  /// The measured repeats. After an interruption they are as complete as the renderer's image and
  /// counts: where a render was cut short, that one alone. Empty: no render was begun.
  std::vector<RenderRun> runs;
  bool interrupted = false;
};

/// `stop` is asked between batches and between renders.
Measurement measure(Renderer& renderer, const Options& options, Progress& progress,
                    const std::function<bool()>& stop);

}  // namespace pt
