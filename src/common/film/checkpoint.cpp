#include "common/film/checkpoint.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "common/error/error.h"
#include "common/film/develop.h"

namespace pt {
namespace {

// EXR has no doubles and no 64-bit numbers: a sum is two channels of 32 bits.
const std::string layer_prefix = "film.";

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }
std::uint64_t bits(std::uint64_t value) { return value; }
void set(double& value, std::uint64_t bits) { value = std::bit_cast<double>(bits); }
void set(std::uint64_t& value, std::uint64_t bits) { value = bits; }

/// Calls visit(layer's name, channels, value(pixel, channel)) for all sums of a film, whose values
/// are references to double or std::uint64_t.
template <class Sums, class Visit>
void for_each_layer(Sums& film, const FilmPlan& plan, std::uint64_t count, Visit&& visit) {
  for (std::uint32_t sign = 0; sign < plan.signs(); ++sign) {
    const std::string name = layer_prefix + (sign == 0 ? "" : "negative.");
    const std::uint64_t first = sign * count;
    visit(
        name + "sum", "RGB", [&, first ](std::uint64_t pixel, std::size_t c) -> auto& {
          return film.pixels[first + pixel].sum[c];
        });
    visit(
        name + "samples", "N", [&, first ](std::uint64_t pixel, std::size_t) -> auto& {
          return film.pixels[first + pixel].samples;
        });
    if (plan.moments) {
      visit(
          name + "luminance_squares", "Y", [&, first ](std::uint64_t pixel, std::size_t) -> auto& {
            return film.moments[first + pixel].luminance_squares;
          });
      visit(
          name + "rays", "CS", [&, first ](std::uint64_t pixel, std::size_t c) -> auto& {
            auto& moments = film.moments[first + pixel];
            return c == 0 ? moments.rays : moments.shadow_rays;
          });
    }
    const std::uint32_t planes = plan.feature_planes();
    std::uint64_t plane = std::uint64_t{sign} * planes;
    const auto visit_feature = [&](const std::string& feature, std::string_view channels) {
      visit(
          name + feature, channels,
          [&, begin = plane * count, count ](std::uint64_t pixel, std::size_t c) -> auto& {
            return film.features[begin + c * count + pixel];
          });
      plane += channels.size();
    };
    if (planes > 0) visit_feature("feature_samples", "N");
    for (const AovInfo& aov : aov_table) {
      if ((plan.aovs & aov.bit) == 0 || aov.source == AovSource::statistics) continue;
      visit_feature("feature." + std::string(aov.name), aov.channels);
    }
  }
}

const std::string halves[] = {".high", ".low"};
constexpr int shifts[] = {32, 0};

void add_layers(const ImageFilm& film, Image& image) {
  const std::uint64_t count = film.window.pixel_count();
  for_each_layer(film, film.plan, count,
                 [&](const std::string& name, std::string_view channels, const auto& value) {
                   for (int half = 0; half < 2; ++half) {
                     ImageLayer layer{name + halves[half], std::string(channels), {}, {}};
                     layer.numbers.reserve(count * channels.size());
                     for (std::uint64_t pixel = 0; pixel < count; ++pixel) {
                       for (std::size_t c = 0; c < channels.size(); ++c) {
                         layer.numbers.push_back(
                             static_cast<std::uint32_t>(bits(value(pixel, c)) >> shifts[half]));
                       }
                     }
                     image.layers.push_back(std::move(layer));
                   }
                 });
}

/// The layer's values by channel, whatever the order that the file has them in.
const ImageLayer& find_layer(const Image& image, const std::string& name,
                             std::string_view channels) {
  const auto found = std::ranges::find(image.layers, name, &ImageLayer::name);
  const bool has_all = found != image.layers.end() && found->channels.size() == channels.size() &&
                       std::ranges::all_of(channels, [&](char c) {
                         return found->channels.find(c) != std::string::npos;
                       });
  if (has_all) return *found;
  throw Error(fmt::format("no layer {} of whole numbers with the channels {}", name, channels));
}

void read_layers(const Image& image, ImageFilm& film) {
  const std::uint64_t count = film.window.pixel_count();
  for_each_layer(film, film.plan, count,
                 [&](const std::string& name, std::string_view channels, const auto& value) {
                   const ImageLayer* layers[2];
                   for (int half = 0; half < 2; ++half) {
                     layers[half] = &find_layer(image, name + halves[half], channels);
                   }
                   for (std::size_t c = 0; c < channels.size(); ++c) {
                     const std::size_t places[] = {layers[0]->channels.find(channels[c]),
                                                   layers[1]->channels.find(channels[c])};
                     for (std::uint64_t pixel = 0; pixel < count; ++pixel) {
                       std::uint64_t both = 0;
                       for (int half = 0; half < 2; ++half) {
                         const std::uint64_t number =
                             layers[half]->numbers[pixel * channels.size() + places[half]];
                         both |= number << shifts[half];
                       }
                       set(value(pixel, c), both);
                     }
                   }
                 });
}

/// A film never has more samples of a pixel, of both signs together, than of its window.
void check_samples(const ImageFilm& film) {
  const std::uint64_t pixels = film.window.pixel_count();
  for (const FilmPart& part : film.parts) {
    const std::uint64_t most = part.next_sample - part.first_sample;
    for (std::uint64_t i = 0; i < part.window.pixel_count(); ++i) {
      const std::uint64_t x = part.window.x + i % part.window.width,
                          y = part.window.y + i / part.window.width;
      const FilmPixel* pixel =
          &film.pixels[(y - film.window.y) * film.window.width + (x - film.window.x)];
      std::uint64_t left = most;
      for (std::uint32_t sign = 0; sign < film.plan.signs(); ++sign, pixel += pixels) {
        if (pixel->samples > left) {
          throw Error(fmt::format("pixel {},{} has {} samples: expected {} at most", x, y,
                                  pixel->samples + (most - left), most));
        }
        left -= pixel->samples;
      }
    }
  }
}

Checkpoint read(const Image& image, ImageMetadata header) {
  const FilmHeader known = parse_film_header(header, image.width, image.height);
  // Before memory is taken for them.
  const FilmSums none;
  for_each_layer(none, known.plan, 0,
                 [&](const std::string& name, std::string_view channels, const auto&) {
                   for (const std::string& half : halves) find_layer(image, name + half, channels);
                 });
  check_header_checksum(header);
  std::erase_if(header, [](const auto& entry) { return entry.first.starts_with(film_key); });
  Checkpoint checkpoint{ImageFilm(known.window, known.plan), std::move(header)};
  ImageFilm& film = checkpoint.film;
  film.parts = known.parts;
  film.tally = known.tally;
  read_layers(image, film);
  if (checksum(film) != known.checksum) {
    throw Error(
        fmt::format("{}checksum: the sums are not those that were written; the file is "
                    "damaged",
                    film_key));
  }
  check_samples(film);
  return checkpoint;
}

}  // namespace

void write_checkpoint(const std::string& path, const Checkpoint& checkpoint,
                      const PixelFilter& filter, ImagePlace image_size) {
  const ImageFilm& film = checkpoint.film;
  explaining("cannot write " + path, [&] { check_samples(film); });  // it could not be read
  Image image = develop(film, filter);
  image.place = image_size;
  if (image_size.width > 0) {
    image.place.x = static_cast<int>(film.window.x),
    image.place.y = static_cast<int>(film.window.y);
  }
  add_layers(film, image);
  image.is_compressed = false;  // the sums' lower halves are noise: a fifth would be saved
  ImageMetadata header = checkpoint.metadata;
  add_film_header(film, header);
  write_image(path, image, header);
}

Checkpoint read_checkpoint(const std::string& path) {
  ImageMetadata header;
  const Image image = read_image_with_numbers(path, layer_prefix, header);
  try {
    return read(image, std::move(header));
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path, error.what()));
  }
}

}  // namespace pt
