// The sums of an image that is made in pieces: by several devices or processes, or in several runs.
// Its windows may have different numbers of samples meanwhile. A window is taken as a film, gets
// more samples, and is put back; so no pixel is ever summed in two places, and the bits of an image
// do not depend on who made which piece when.
#pragma once

#include "common/film/film_data.h"

namespace pt {

/// The pixels of a window all have the samples [first_sample, next_sample).
struct FilmPart {
  Window window;
  std::uint32_t first_sample = 0, next_sample = 0;

  bool operator==(const FilmPart&) const = default;
  std::uint64_t samples() const { return window.pixel_count() * (next_sample - first_sample); }
};

struct ImageFilm : FilmSums {
  Window window;
  FilmPlan plan;                ///< which sums it has
  std::vector<FilmPart> parts;  ///< disjoint, within the window; elsewhere there are no samples
  PathTally tally;              ///< of all samples

  /// Without samples.
  ImageFilm(const Window& window, const FilmPlan& plan);

  /// The pixels of `part`, to be continued. Its tally is zero: it will count what is added. Throws
  /// Error unless all of them have the same samples, or none. `memory` is used again, and
  /// what it holds means nothing in a film without samples: pages that are new to a process, and
  /// zeros, take longer than the copy.
  Film take(const Window& part, FilmSums&& memory = {}) const;
  /// Replaces the pixels of the film's window by the film's, and adds its tally.
  void put(const Film& film);

  /// No pixel has samples.
  void clear() { parts.clear(), tally = {}; }

  /// The parts of `where` that have fewer samples than `next_sample`, those without any included,
  /// by rising number of samples.
  std::vector<FilmPart> lacking(const Window& where, std::uint32_t next_sample) const;
  /// The fewest samples that a pixel of these windows has.
  std::uint32_t least_samples(const std::vector<Window>& where) const;
  std::uint32_t least_samples() const { return least_samples({window}); }
  /// All pixels together.
  std::uint64_t samples() const;
};

/// The pixels of `a` that are not in `b`: at most four windows.
std::vector<Window> subtract(const Window& a, const Window& b);

/// The pixels in both; without pixels where there are none.
Window intersect(const Window& a, const Window& b);

}  // namespace pt
