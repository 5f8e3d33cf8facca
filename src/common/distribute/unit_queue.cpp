#include "common/distribute/unit_queue.h"

#include <algorithm>

namespace pt {
namespace {

/// Larger ones would come home too seldom, and take long to copy.
constexpr std::uint64_t window_pixels_max = std::uint64_t{1} << 21;

/// Cuts windows of about so many pixels from the front of a list of windows: whole rows, or a part
/// of one where a row is wider than that.
class Cutter {
 public:
  explicit Cutter(std::vector<Window> windows) : windows_(std::move(windows)) {
    std::erase_if(windows_, [](const Window& w) { return w.pixel_count() == 0; });
    std::ranges::reverse(windows_);
    for (const Window& w : windows_) left_ += w.pixel_count();
  }

  std::uint64_t left() const { return left_; }

  Window cut(std::uint64_t pixels) {
    Window& from = windows_.back();
    Window piece = from;
    if (pixels < from.width) {
      piece.width = static_cast<std::uint32_t>(std::max<std::uint64_t>(pixels, 1));
      piece.height = 1;
      cut_from_row(from, piece.width);
    } else {
      const std::uint64_t wanted = (pixels + from.width - 1) / from.width;
      const std::uint64_t rows = std::min<std::uint64_t>(wanted, from.height);
      piece.height = static_cast<std::uint32_t>(rows);
      from.y += piece.height, from.height -= piece.height;
      if (from.height == 0) windows_.pop_back();
    }
    left_ -= piece.pixel_count();
    return piece;
  }

 private:
  /// The first row becomes a window of its own, without its first pixels.
  void cut_from_row(Window& from, std::uint32_t width) {
    Window row = from;
    row.height = 1, row.x += width, row.width -= width;
    from.y += 1, from.height -= 1;
    if (from.height == 0) windows_.pop_back();
    if (row.width > 0) windows_.push_back(row);
  }

  std::vector<Window> windows_;  ///< the next one is the last
  std::uint64_t left_ = 0;
};

}  // namespace

std::vector<Window> divide_pixels(const std::vector<Window>& where, int samples,
                                  const UnitRule& rule) {
  Cutter cutter(where);
  std::vector<Window> windows;
  const auto workers = static_cast<std::uint64_t>(rule.workers);
  // Long renders divide samples as well: there is no need for windows of few pixels.
  constexpr std::uint64_t smallest_share = 64;  // of a worker's
  const auto wanted = static_cast<std::uint64_t>(samples);
  const std::uint64_t least =
      std::min(window_pixels_max, std::max((rule.least_paths + wanted - 1) / wanted,
                                           cutter.left() / (smallest_share * workers)));
  if (rule.windows_per_worker > 0) {
    const std::uint64_t count = workers * static_cast<std::uint64_t>(rule.windows_per_worker);
    const std::uint64_t pixels = (cutter.left() + count - 1) / count;
    while (cutter.left() > 0) windows.push_back(cutter.cut(pixels));
    return windows;
  }
  while (cutter.left() > 0) {
    const std::uint64_t share = workers == 1 ? cutter.left() : cutter.left() / (4 * workers);
    const std::uint64_t pixels = std::clamp(share, least, window_pixels_max);
    for (std::uint64_t i = 0; i < workers && cutter.left() > 0; ++i) {
      windows.push_back(cutter.cut(pixels));
    }
  }
  return windows;
}

UnitQueue::UnitQueue(std::vector<FilmPart> parts, std::uint32_t end) : end_(end) {
  for (const FilmPart& part : parts) {
    if (part.next_sample >= end) continue;
    entries_.push_back({part});
    left_ += entries_.back().paths_left(end);
    largest_ = std::max(largest_, part.window.pixel_count());
  }
}

std::optional<UnitSpan> UnitQueue::next(std::uint64_t paths, std::uint64_t even_paths) {
  const bool is_even = left_ > even_paths;
  Entry* best = nullptr;
  for (Entry& entry : entries_) {
    if (entry.in_work) continue;
    const bool is_better =
        best == nullptr || (is_even ? entry.part.next_sample < best->part.next_sample
                                    : entry.paths_left(end_) > best->paths_left(end_));
    if (is_better) best = &entry;
  }
  if (best == nullptr) return std::nullopt;
  best->in_work = true;
  const std::uint64_t left = end_ - best->part.next_sample;
  const std::uint64_t fitting = paths / (is_even ? largest_ : best->part.window.pixel_count());
  // Not a small rest.
  const std::uint64_t samples =
      left <= fitting + fitting / 2 ? left : std::clamp<std::uint64_t>(fitting, 1, left);
  return UnitSpan{best->part, static_cast<int>(samples)};
}

void UnitQueue::end(const Window& window, std::uint32_t next_sample) {
  const auto found =
      std::ranges::find_if(entries_, [&](const Entry& e) { return e.part.window == window; });
  if (found == entries_.end()) return;
  left_ -= found->paths_left(end_);
  found->part.next_sample = next_sample;
  found->in_work = false;
  left_ += found->paths_left(end_);
  if (next_sample >= end_) entries_.erase(found);
}

}  // namespace pt
