// The renders of one measurement: warm-ups, then repeats, until all are done or stopped.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/render/renderer.h"

namespace pt {

struct Measurement {
  /// The measured repeats; if a render was cut short, only that one, which the renderer's image and
  /// counts belong to. Empty: no render was begun.
  std::vector<RenderRun> runs;
  bool interrupted = false;
};

/// What a measurement reports and asks meanwhile. `stop` must not be empty.
struct MeasureHooks {
  /// A render begins: "rendering", "warm-up 1 of 2".
  std::function<void(const std::string& label)> begin;
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;  ///< as RenderHooks
  /// Asked between batches and between renders, and while a batch is traced, by any thread.
  std::function<bool()> stop;
  std::function<void(const std::function<Image()>& image)> watch{};  ///< as RenderHooks
};

Measurement measure(Renderer& renderer, const Options& options, const MeasureHooks& hooks);

}  // namespace pt
