#include "app/render/measure.h"

#include <fmt/format.h>

#include "common/platform/steady_seconds.h"

namespace pt {
namespace {

std::string label(const Options& options, int index) {
  if (index < options.warmup) return fmt::format("warm-up {} of {}", index + 1, options.warmup);
  if (options.repeat == 1) return "rendering";
  return fmt::format("render {} of {}", index - options.warmup + 1, options.repeat);
}

}  // namespace

Measurement measure(Renderer& renderer, const Options& options, const MeasureHooks& own) {
  const auto& stop = own.stop;
  const RenderHooks hooks{
      own.progress, stop, {options.time_limit, options.target_error, {}}, stop, own.watch};
  Measurement measurement;
  RenderRun last;
  for (int i = 0; i < options.warmup + options.repeat; ++i) {
    if (stop()) {
      measurement.interrupted = true;
      if (i > 0 && measurement.runs.empty()) measurement.runs = {last};
      break;
    }
    if (own.begin) own.begin(label(options, i));
    const double begin_s = steady_seconds();
    last = renderer.render(hooks);
    last.wall_ms = 1e3 * (steady_seconds() - begin_s);
    if (is_cut_short(last, options.spp)) {
      measurement = {{last}, true};
      break;
    }
    if (i >= options.warmup) measurement.runs.push_back(last);
  }
  return measurement;
}

}  // namespace pt
