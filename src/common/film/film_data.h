// A film in memory, owned: a part of an image's pixels and of their samples, to be kept, continued
// and merged with others without changing a bit.
#pragma once

#include <string>
#include <vector>

#include "common/film/film_planes.h"

namespace pt {

/// For messages, as "600x300 at 0,0".
std::string text(const Window& window);

/// The arrays of FilmView, owned.
struct FilmSums {
  std::vector<FilmPixel> pixels;      ///< [sign][y][x] of the window; empty: no sample was taken
  std::vector<PixelMoments> moments;  ///< [sign][y][x], where the FilmPlan has them
  std::vector<double> features;       ///< [sign][plane][y][x], where the FilmPlan has them

  /// Zero, for so many pixels.
  void reset(const FilmPlan& plan, std::uint64_t pixel_count);
  /// As large as reset() makes them.
  bool have(const FilmPlan& plan, std::uint64_t pixel_count) const;
};

/// The samples [first_sample, next_sample) of the pixels of `window`, summed in double precision
/// and in their order. A sum of doubles depends on that order, so samples are only ever added after
/// those that the film has: a film is continued (Renderer::render), while two sums of one pixel
/// are never added to each other. Films of different pixels can be merged in any order. All films
/// of an image come of one scene and of the same options, but for how they are executed.
struct Film : FilmSums {
  Window window;
  std::uint32_t first_sample = 0, next_sample = 0;  ///< counted from the image's first
  PathTally tally;
  std::vector<Window> parts;  ///< of the window, disjoint: the pixels that have the samples

  bool is_empty() const { return parts.empty(); }
  /// All pixels have the samples.
  bool is_complete() const;
};

/// Copies the pixels of `part` to their position in `film`, which has no samples of them, and adds
/// the counts. Throws Error unless they lie in its window and both have the same samples (an empty
/// film takes any).
void merge(Film& film, const Film& part);

PathTally operator+(PathTally a, const PathTally& b);

}  // namespace pt
