#include "app/render/measure.h"

#include <fmt/format.h>

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
    const double begin_s = Progress::steady_seconds();
    last = renderer.render(hooks);
    last.wall_ms = 1e3 * (Progress::steady_seconds() - begin_s);
    if (is_cut_short(last, options.spp)) {
      measurement = {{last}, true};
      break;
    }
    if (i >= options.warmup) measurement.runs.push_back(last);
  }
  return measurement;
}

Measurement measure(Renderer& renderer, const Options& options, Progress& progress,
                    const std::function<bool()>& stop) {
  MeasureHooks hooks;
  hooks.begin = [&](const std::string& text) { progress.begin(text); };
  hooks.progress = [&](std::uint64_t done, std::uint64_t total) { progress.update(done, total); };
  hooks.stop = stop;
  const Measurement measurement = measure(renderer, options, hooks);
  progress.finish();
  return measurement;
}

}  // namespace pt
