#include "common/film/develop.h"

#include <numeric>
#include <span>

namespace pt {

Image develop(std::span<const FilmPixel> film, int width, int height) {
  Image image{width, height, {}};
  image.rgb.reserve(3 * film.size());
  for (const FilmPixel& pixel : film) {
    const double scale = pixel.samples == 0 ? 0.0 : 1.0 / static_cast<double>(pixel.samples);
    for (const double sum : pixel.sum) image.rgb.push_back(static_cast<float>(sum * scale));
  }
  return image;
}

PathCounts summarize(const PathTally& tally) {
  const std::span<const std::uint64_t> lengths(tally.lengths);
  PathCounts counts;
  counts.paths = std::accumulate(lengths.begin(), lengths.end(), std::uint64_t{0});
  counts.rays = tally.rays;
  counts.shadow_rays = tally.shadow_rays;
  counts.nonfinite_samples = tally.nonfinite;
  // A path of k rays was alive for each of them.
  for (std::uint64_t live = counts.paths; const std::uint64_t ended : lengths) {
    if (live == 0) break;
    counts.live_paths.push_back(live);
    live -= ended;
  }
  return counts;
}

}  // namespace pt
