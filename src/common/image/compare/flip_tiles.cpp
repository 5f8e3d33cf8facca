#include "common/image/compare/flip_tiles.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>

#include "common/image/compare/flip_filters.h"

namespace pt {
namespace {

/// Pixels [x0, x1) x [y0, y1).
struct Part {
  int x0, y0, x1, y1;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
};

Part widened(const Part& part, int by, const Image& image) {
  return {std::max(part.x0 - by, 0), std::max(part.y0 - by, 0), std::min(part.x1 + by, image.width),
          std::min(part.y1 + by, image.height)};
}

std::size_t pixel_index(const Image& image, int x, int y) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
         static_cast<std::size_t>(x);
}

bool are_same(const Image& a, const Image& b, const Part& part) {
  const auto bytes = 3 * sizeof(float) * static_cast<std::size_t>(part.width());
  for (int y = part.y0; y < part.y1; ++y) {
    const std::size_t first = 3 * pixel_index(a, part.x0, y);
    if (std::memcmp(&a.rgb[first], &b.rgb[first], bytes) != 0) return false;
  }
  return true;
}

Image cut(const Image& image, const Part& part) {
  Image result{part.width(), part.height(), {}};
  for (int y = part.y0; y < part.y1; ++y) {
    const auto first =
        image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * pixel_index(image, part.x0, y));
    result.rgb.insert(result.rgb.end(), first, first + 3 * part.width());
  }
  return result;
}

}  // namespace

std::vector<float> flip_by_tiles(const Image& test, const Image& reference, const FlipView& view,
                                 const FlipOfParts& flip_of_parts) {
  const int reach = flip::reach(view.pixels_per_degree);
  const int columns = (reference.width + view.tile - 1) / view.tile;
  const int rows = (reference.height + view.tile - 1) / view.tile;
  std::vector<float> errors(reference.rgb.size() / 3, 0.0f);
  tbb::parallel_for(0, columns * rows, [&](int i) {
    const int x = i % columns * view.tile, y = i / columns * view.tile;
    const Part tile = widened({x, y, x + view.tile, y + view.tile}, 0, reference);
    const Part part = widened(tile, reach, reference);
    if (are_same(test, reference, part)) return;
    const std::vector<float> found = flip_of_parts(cut(test, part), cut(reference, part));
    for (int row = tile.y0; row < tile.y1; ++row) {
      const std::ptrdiff_t from =
          std::ptrdiff_t{row - part.y0} * part.width() + (tile.x0 - part.x0);
      std::copy_n(
          found.begin() + from, tile.width(),
          errors.begin() + static_cast<std::ptrdiff_t>(pixel_index(reference, tile.x0, row)));
    }
  });
  return errors;
}

}  // namespace pt
