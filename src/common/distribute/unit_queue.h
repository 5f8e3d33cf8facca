// Which unit is next: an image's pixels divided into windows, and each window's samples taken by
// portions. Plain values without threads, so that the rules can be tested.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/film/image_film.h"

namespace pt {

/// How pixels are divided into windows.
struct UnitRule {
  int workers = 1;
  /// Paths that keep a worker busy: no window has fewer, unless the image has.
  std::uint64_t least_paths = 1;
  /// Above 0: so many windows of one size for each worker. For experiments.
  int windows_per_worker = 0;
};

/// Divides the pixels of `where` into windows of rows, for a render of `samples` per pixel. By
/// factoring (Hummel, Schonberg and Flynn 1992): as many windows as there are workers, of a share
/// of half of the pixels, then so of the rest, until a window would be too small. The large ones
/// cost little to hand out, and the small ones, taken last, let all workers end at about the same
/// time. Of one worker no more than are needed.
std::vector<Window> divide_pixels(const std::vector<Window>& where, int samples,
                                  const UnitRule& rule);

/// A window's next samples: [part.next_sample, part.next_sample + samples).
struct UnitSpan {
  FilmPart part;
  int samples = 0;
};

/// Hands out the samples of windows until each pixel has the wanted number. A window is with one
/// worker at a time.
class UnitQueue {
 public:
  /// `parts`: disjoint windows and what they have, to get samples up to `end`.
  UnitQueue(std::vector<FilmPart> parts, std::uint32_t end);

  /// The next unit of about `paths` paths, at least one sample; none if all that is left is in
  /// work. While more than `even_paths` are left, of the window with the fewest samples, and as
  /// many as the largest window would get, so that the image grows evenly; then of the one that
  /// lacks most, so that the end is even.
  std::optional<UnitSpan> next(std::uint64_t paths, std::uint64_t even_paths);
  /// The unit has ended, and its pixels have samples up to `next_sample`.
  void end(const Window& window, std::uint32_t next_sample);

  /// All pixels have their samples.
  bool is_done() const { return left_ == 0; }
  /// Paths that are not yet taken, those in work included.
  std::uint64_t paths_left() const { return left_; }

 private:
  struct Entry {
    FilmPart part;
    bool in_work = false;

    std::uint64_t paths_left(std::uint32_t end) const {
      return part.window.pixel_count() * (end - part.next_sample);
    }
  };

  std::vector<Entry> entries_;
  std::uint32_t end_;
  std::uint64_t left_ = 0;
  std::uint64_t largest_ = 1;  ///< pixels of the largest window
};

}  // namespace pt
