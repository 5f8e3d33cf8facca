// Who takes samples of windows: a device of this process, or one of another process. The group
// (group_renderer.h) hands out units and takes their films back; it alone knows the image.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/film/film_data.h"
#include "common/options/stats.h"

namespace pt {

/// A unit of work: `samples` more for each pixel of the film's window. `film` has what the window
/// has so far, or no samples, and a tally of zero.
struct Unit {
  std::uint64_t id = 0;  ///< of the group; its result has it, too
  Film film;
  int samples = 0;
};

/// What became of a unit. `film` has fewer samples than were asked for where it was cancelled.
struct UnitResult {
  std::uint64_t id = 0;
  Film film;
  RenderRun run;
  double wall_ms = 0;   ///< from the unit's beginning to its film
  std::string error;    ///< empty: none; else the worker cannot go on, and the unit was not done
  std::string warning;  ///< of the worker, which goes on; empty: none
};

class Worker {
 public:
  virtual ~Worker() = default;

  /// How messages and reports call it: "cuda:1", "rank 3 (host7) cuda:0".
  virtual std::string name() const = 0;
  /// Units that it takes at once: 2 where the next one should be there when one ends.
  virtual int capacity() const { return 1; }
  /// Paths of a unit that keep it busy: fewer leave a part of the device idle.
  virtual std::uint64_t least_paths() const = 0;
  virtual void begin(Unit&& unit) = 0;
  /// A unit that has ended, in the order of begin(). Does not wait.
  virtual std::optional<UnitResult> poll() = 0;
  /// Units that have begun end with the samples that they have, those that wait without any more.
  virtual void cancel() = 0;
  /// Fills in what is known of the device: name, memory, kernels, times of set-up. No unit has
  /// begun that has not ended.
  virtual void describe(RenderReport& report) = 0;
};

}  // namespace pt
