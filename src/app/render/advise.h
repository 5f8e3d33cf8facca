// Which mode and which few options render a scene fastest: found by rendering it in the ways among
// which `auto` chooses (ptexp advise).
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/options/command_line.h"
#include "common/options/stats.h"

namespace pt {

class RenderSession;
struct RenderResult;

/// Options beside those that the user gave, by name and value: what makes a way to render differ.
using WayOptions = std::vector<std::pair<std::string, std::string>>;

/// What one render took.
struct WayRun {
  double kernel_ms = 0, wall_ms = 0;
  double build_ms = 0;  ///< of the tree, once for all renders
  std::vector<StageTime> stages;
  PathCounts counts;
  std::string device;
  bool is_on_gpu = false;
  std::optional<HardwareCounters> counters;  ///< where they were asked for
};

/// Of a measurement, whose kernel time is the median of its repeats. Empty: it was interrupted.
std::optional<WayRun> way_run(const RenderResult& result);

/// What of the render is rendered: less than all where all would take too long.
struct WayWork {
  int samples = 1;                                           ///< per pixel
  double scale = 1;                                          ///< of width and height, in (0, 1]
  double limit_s = std::numeric_limits<double>::infinity();  ///< of wall time, the tree included
};

/// How ways are planned and rendered. Both functions throw Error for ways that do not exist for the
/// scene and the device. Tests have planted times.
struct WayMeasurer {
  std::function<std::vector<Decision>(const WayOptions& options)> plan;
  /// After one more render if `warms_up`. Empty: interrupted, or out of time.
  std::function<std::optional<WayRun>(const WayOptions& options, const WayWork& work, bool warms_up,
                                      bool counts)>
      render;
  std::function<double()> clock_s;
};

struct AdvisedWay {
  WayOptions options;         ///< empty: the default
  std::string mode;           ///< of its plan
  double total_ms = 0;        ///< tree and kernels for all samples, median over the rounds
  double ratio = 1;           ///< median over the rounds of the default's total time over its own
  double low = 1, high = 1;   ///< 95 % interval of the ratio; 0 and infinity: unknown
  std::string word = "same";  ///< by the interval: faster, slower, same (within 2 %) or ambiguous
  WayRun run;                 ///< the last one
};

struct Advice {
  AdvisedWay standard;           ///< what `auto` chooses
  std::string why;               ///< the plan's reason for the default's mode
  std::vector<AdvisedWay> ways;  ///< measured in turns with it, the fastest first
  int tried = 0;                 ///< ways in all, the default included
  int rounds = 0;
  WayWork work;            ///< that was rendered
  int wanted_samples = 0;  ///< per pixel
  double seconds = 0;      ///< that measuring took

  /// The way to take: one that is faster for sure and by more than 2 %, else the default.
  const AdvisedWay& best() const;
};

/// Measures until the ratios are known to 1 %, at most for `limit_s` seconds and what the render
/// at work then takes on CUDA, where it also reads the hardware's counters of the fastest way of
/// each mode. `spp`: the samples that are wanted. `given`: options that are not to be changed.
/// Empty: out of time before anything was measured. Throws Error where the scene cannot be
/// rendered.
std::optional<Advice> advise(const WayMeasurer& measurer, int spp, const GivenOptions& given,
                             double limit_s);

struct AdviceRequest {
  std::vector<Setting> settings;  ///< the user's options of rendering
  double limit_s = 60;
  std::function<bool()> stop;                        ///< true ends it
  std::function<void(const std::string& way)> says;  ///< told what is tried; may be empty
};

/// The same for a scene in memory. Empty also if `stop` ended it. Throws Error.
std::optional<Advice> advise(RenderSession& session, const AdviceRequest& request);

/// "--mode megakernel --accel bvh2"; "the default" without options.
std::string way_text(const WayOptions& options);

/// At most ten lines: which to use, how sure that is, and why.
std::string advice_text(const Advice& advice);

}  // namespace pt
