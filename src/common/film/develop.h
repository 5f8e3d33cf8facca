// The film becomes an image, the tally becomes the counts of a report.
#pragma once

#include <span>

#include "common/film/film.h"
#include "common/image/image.h"
#include "common/render/stats.h"

namespace pt {

/// Mean of each pixel's samples; black where it has none.
Image develop(std::span<const FilmPixel> film, int width, int height);

PathCounts summarize(const PathTally& tally);

}  // namespace pt
