// The film becomes an image, the tally becomes the counts of a report.
#pragma once

#include <span>

#include "common/film/image_film.h"
#include "common/image/image.h"
#include "common/options/stats.h"

namespace pt {

/// Mean of each pixel's samples; black where it has none.
Image develop(std::span<const FilmPixel> film, int width, int height);

/// A window with a filter, and the layers of the plan's AOVs. `samples`: of each pixel.
/// The sums may be larger than the window.
Image develop(const FilmSums& sums, const FilmPlan& plan, const PixelFilter& filter,
              const Window& window, std::uint64_t samples);

/// All pixels, each with the samples that it has; pixels without are black, and zero in layers.
Image develop(const ImageFilm& film, const PixelFilter& filter);

PathCounts summarize(const PathTally& tally);

}  // namespace pt
