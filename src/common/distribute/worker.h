// Who takes samples of windows: a device of this process, or one of another process. The group
// (group_renderer.h) hands out units and takes their films back; it is the only one that knows the
// image.
#pragma once

#include <optional>
#include <string>

#include "common/film/film_data.h"
#include "common/options/stats.h"

namespace pt {

/// A unit of work: `samples` more for each pixel of the film's window. `film` has what the window
/// has so far (or no samples), with a tally of zero.
struct Unit {
  std::uint64_t id = 0;  ///< of the group: what comes back has it, too
  Film film;
  int samples = 0;
};

/// What became of it. `film` has fewer samples than were asked for where it was interrupted;
/// without samples it is to be taken for the unit's as it was.
struct UnitResult {
  std::uint64_t id = 0;
  Film film;
  RenderRun run;
  double wall_ms = 0;  ///< from the unit's begin to its film
  std::string error;   ///< empty: none; else the worker cannot go on, and the unit is lost
};

class Worker {
 public:
  virtual ~Worker() = default;

  /// How it is called in messages and reports: "cuda:1", "rank 3 (host7) cuda:0".
  virtual std::string name() const = 0;
  /// Units that it may have at once: 2 where the next one should be there when one ends.
  virtual int capacity() const = 0;
  virtual void begin(Unit&& unit) = 0;
  /// A unit that has ended, in the order of begin(). Does not wait.
  virtual std::optional<UnitResult> poll() = 0;
  /// Units that have begun end with the samples that they have; those that wait end with none.
  virtual void cancel() = 0;
  /// Once at least one unit has ended: device, memory, kernels, set-up times.
  virtual void describe(RenderReport& report) = 0;
};

}  // namespace pt
