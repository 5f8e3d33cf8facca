// The renders of one measurement: warm-ups, then repeats, until they are done or someone stops
// them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/terminal/progress.h"
#include "common/render/renderer.h"

namespace pt {

struct Measurement {
  /// The measured repeats. After an interruption they are as complete as the renderer's image and
  /// counts: where a render was cut short, that one alone. Empty: no render was begun.
  std::vector<RenderRun> runs;
  bool interrupted = false;
};

/// What a measurement tells and asks meanwhile. `stop` must be there.
struct MeasureHooks {
  /// A render begins: "rendering", "warm-up 1 of 2".
  std::function<void(const std::string& label)> begin;
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;  ///< as RenderHooks
  /// Asked between batches and between renders, and while a batch is traced, by any thread.
  std::function<bool()> stop;
  std::function<void(const std::function<Image()>& image)> watch{};  ///< as RenderHooks
};

Measurement measure(Renderer& renderer, const Options& options, const MeasureHooks& hooks);

/// Of a render whose progress is shown.
Measurement measure(Renderer& renderer, const Options& options, Progress& progress,
                    const std::function<bool()>& stop);

}  // namespace pt
