#include "common/film/develop.h"

#include <algorithm>
#include <numeric>
#include <span>

#include "common/film/pixel_statistics.h"

namespace pt {
namespace {

ImageLayer blank_layer(std::string_view name, std::string_view channels, std::uint64_t pixel_count,
                       bool has_numbers) {
  ImageLayer layer{std::string(name), std::string(channels), {}, {}};
  const std::uint64_t count = pixel_count * channels.size();
  has_numbers ? layer.numbers.resize(count) : layer.values.resize(count);
  return layer;
}

/// `plane`: the AOV's first one.
template <class Aov>
ImageLayer make_layer(const PixelReader& reader, std::uint64_t pixel_count, std::uint64_t samples,
                      std::uint32_t plane) {
  const std::string_view channels = Aov::channels;
  constexpr bool has_numbers = aov_source<Aov> == AovSource::number;
  ImageLayer layer = blank_layer(Aov::name, channels, pixel_count, has_numbers);
  for (std::uint64_t pixel = 0; pixel < pixel_count; ++pixel) {
    if constexpr (aov_source<Aov> == AovSource::statistics) {
      layer.values[pixel] = Aov::of(reader.statistics(pixel, samples));
    } else {
      for (std::uint32_t c = 0; c < channels.size(); ++c) {
        const std::uint64_t index = pixel * channels.size() + c;
        if constexpr (has_numbers) {
          layer.numbers[index] = reader.number(pixel, plane + c);
        } else {
          layer.values[index] = static_cast<float>(reader.feature(pixel, plane + c));
        }
      }
    }
  }
  return layer;
}

}  // namespace

Image develop(std::span<const FilmPixel> film, int width, int height) {
  Image image{width, height, {}};
  image.rgb.reserve(3 * film.size());
  for (const FilmPixel& pixel : film) {
    const double to_mean = pixel.to_mean();
    for (const double sum : pixel.sum) image.rgb.push_back(static_cast<float>(sum * to_mean));
  }
  return image;
}

Image develop(const FilmSums& sums, const FilmPlan& plan, const PixelFilter& filter,
              const Window& window, std::uint64_t samples) {
  Image image{static_cast<int>(window.width), static_cast<int>(window.height), {}};
  const std::uint64_t pixel_count = window.pixel_count();
  const PixelReader reader(sums, plan, filter, pixel_count);
  image.rgb.reserve(3 * pixel_count);
  for (std::uint64_t pixel = 0; pixel < pixel_count; ++pixel) {
    for (const double value : reader.value(pixel)) image.rgb.push_back(static_cast<float>(value));
  }
  std::uint32_t plane = 1;
  for_each_type(Aovs{}, [&](auto type) {
    using Aov = typename decltype(type)::type;
    if ((plan.aovs & aov_bit<Aov>) == 0) return;
    image.layers.push_back(make_layer<Aov>(reader, pixel_count, samples, plane));
    if (aov_source<Aov> != AovSource::statistics) {
      plane += static_cast<std::uint32_t>(image.layers.back().channels.size());
    }
  });
  return image;
}

namespace {

/// Copies rows of `count` values for a pixel from a part of the image.
template <class T>
void paste(const std::vector<T>& from, const Window& part, std::vector<T>& to, const Window& image,
           std::size_t count) {
  to.resize(image.pixel_count() * count);
  if (from.empty()) return;
  for (std::size_t y = 0; y < part.height; ++y) {
    const std::size_t row = (part.y - image.y + y) * image.width + (part.x - image.x);
    std::copy_n(&from[y * part.width * count], part.width * count, &to[row * count]);
  }
}

}  // namespace

Image develop(const ImageFilm& film, const PixelFilter& filter) {
  // Without samples: black, and the layers that there are.
  FilmSums blank;
  blank.reset(film.plan, 1);
  Image image = develop(blank, film.plan, filter, {0, 0, 1, 1}, 0);
  image.width = static_cast<int>(film.window.width);
  image.height = static_cast<int>(film.window.height);
  image.rgb.assign(3 * film.window.pixel_count(), 0.0f);
  for (ImageLayer& layer : image.layers) {
    const std::uint64_t count = film.window.pixel_count() * layer.channels.size();
    layer.numbers.empty() ? layer.values.assign(count, 0.0f) : layer.numbers.assign(count, 0);
  }
  for (const FilmPart& part : film.parts) {
    const Image piece = develop(film.take(part.window), film.plan, filter, part.window,
                                part.next_sample - part.first_sample);
    paste(piece.rgb, part.window, image.rgb, film.window, 3);
    for (std::size_t i = 0; i < image.layers.size(); ++i) {
      ImageLayer& layer = image.layers[i];
      const std::size_t channels = layer.channels.size();
      if (!layer.values.empty())
        paste(piece.layers[i].values, part.window, layer.values, film.window, channels);
      if (!layer.numbers.empty())
        paste(piece.layers[i].numbers, part.window, layer.numbers, film.window, channels);
    }
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
