#include "common/film/checkpoint.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <span>

#include "common/error/error.h"
#include "common/film/develop.h"

namespace pt {
namespace {

// EXR has no doubles and no 64-bit numbers: a sum is two channels of 32 bits.
const std::string layer_prefix = "film.", key_prefix = "ptexp.film.";
constexpr int format_version = 1;

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
    for (std::uint32_t plane = 0; plane < planes; ++plane) {
      const std::uint64_t begin = (std::uint64_t{sign} * planes + plane) * count;
      visit(
          fmt::format("{}feature{}", name, plane), "F",
          [&, begin ](std::uint64_t pixel, std::size_t) -> auto& {
            return film.features[begin + pixel];
          });
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

template <class T>
void add_checksum(const std::vector<T>& values, std::uint32_t& sum) {
  if (values.empty()) return;  // zlib starts again where it is given no bytes
  const auto* const bytes = reinterpret_cast<const Bytef*>(values.data());
  sum = static_cast<std::uint32_t>(crc32_z(sum, bytes, values.size() * sizeof(T)));
}

std::uint32_t checksum(const FilmSums& sums) {
  static_assert(sizeof(FilmPixel) == 32 && sizeof(PixelMoments) == 24);  // no padding
  std::uint32_t sum = 0;
  add_checksum(sums.pixels, sum);
  add_checksum(sums.moments, sum);
  add_checksum(sums.features, sum);
  return sum;
}

std::string numbers_text(std::span<const std::uint64_t> numbers) {
  return fmt::format("{}", fmt::join(numbers, " "));
}

std::vector<std::uint64_t> parse_numbers(const ImageMetadata& header, const std::string& key) {
  const auto found = header.find(key_prefix + key);
  if (found == header.end()) throw Error(fmt::format("no attribute {}{}", key_prefix, key));
  const std::string& text = found->second;
  std::vector<std::uint64_t> numbers;
  for (const char *at = text.data(), *end = at + text.size(); at < end;) {
    const auto [stop, error] = std::from_chars(at, end, numbers.emplace_back());
    if (error != std::errc() || (stop != end && *stop != ' ')) {
      throw Error(fmt::format("{}{} {}: expected whole numbers", key_prefix, key, text));
    }
    at = stop + 1;
  }
  return numbers;
}

/// The same, of so many.
std::vector<std::uint64_t> parse_numbers(const ImageMetadata& header, const std::string& key,
                                         std::size_t count) {
  std::vector<std::uint64_t> numbers = parse_numbers(header, key);
  if (numbers.size() == count) return numbers;
  throw Error(
      fmt::format("{}{}: expected {} numbers, found {}", key_prefix, key, count, numbers.size()));
}

void add_header(const ImageFilm& film, ImageMetadata& header) {
  const auto add = [&](const std::string& key, std::vector<std::uint64_t> numbers) {
    header[key_prefix + key] = numbers_text(numbers);
  };
  add("format", {format_version});
  add("window", {film.window.x, film.window.y, film.window.width, film.window.height});
  add("plan", {film.plan.aovs, film.plan.moments, film.plan.two_signs});
  std::vector<std::uint64_t> parts;
  for (const FilmPart& part : film.parts) {
    const Window& w = part.window;
    for (const std::uint32_t n : {w.x, w.y, w.width, w.height, part.first_sample, part.next_sample})
      parts.push_back(n);
  }
  add("parts", parts);
  const PathTally& tally = film.tally;
  std::vector<std::uint64_t> counts{tally.rays, tally.shadow_rays, tally.nonfinite};
  counts.insert(counts.end(), std::begin(tally.lengths), std::end(tally.lengths));
  add("tally", counts);
  add("checksum", {checksum(film)});
}

Window window_in(std::span<const std::uint64_t> numbers) {
  Window w;
  std::uint32_t* const fields[] = {&w.x, &w.y, &w.width, &w.height};
  for (std::size_t i = 0; i < 4; ++i) {
    if (numbers[i] > 65535)
      throw Error(fmt::format("a window with {}: expected 0 to 65535", numbers[i]));
    *fields[i] = static_cast<std::uint32_t>(numbers[i]);
  }
  return w;
}

std::vector<FilmPart> parts_in(const ImageMetadata& header, const Window& window) {
  const std::vector<std::uint64_t> numbers = parse_numbers(header, "parts");
  constexpr std::size_t fields = 6;
  if (numbers.size() % fields != 0) {
    throw Error(
        fmt::format("{}parts: expected x y width height first_sample next_sample of each, "
                    "found {} numbers",
                    key_prefix, numbers.size()));
  }
  std::vector<FilmPart> parts;
  for (std::size_t i = 0; i < numbers.size(); i += fields) {
    FilmPart part{window_in(std::span(numbers).subspan(i, 4)), 0, 0};
    const std::uint64_t first = numbers[i + 4], next = numbers[i + 5];
    part.first_sample = static_cast<std::uint32_t>(first);
    part.next_sample = static_cast<std::uint32_t>(next);
    const bool overlaps = std::ranges::any_of(
        parts, [&](const FilmPart& other) { return other.window.overlaps(part.window); });
    if (first > next || next > UINT32_MAX || overlaps || part.window.pixel_count() == 0 ||
        !window.contains(part.window)) {
      throw Error(
          fmt::format("{}parts: expected disjoint windows of the image, with samples that "
                      "ascend",
                      key_prefix));
    }
    parts.push_back(part);
  }
  return parts;
}

PathTally tally_in(const ImageMetadata& header) {
  const auto numbers = parse_numbers(header, "tally", 3 + path_length_bins);
  PathTally tally;
  tally.rays = numbers[0], tally.shadow_rays = numbers[1], tally.nonfinite = numbers[2];
  std::copy(numbers.begin() + 3, numbers.end(), std::begin(tally.lengths));
  return tally;
}

void check_format(const ImageMetadata& header) {
  if (!header.contains(key_prefix + "format")) {
    throw Error(
        fmt::format("no attribute {}format; expected a checkpoint, which --checkpoint "
                    "writes",
                    key_prefix));
  }
  const std::uint64_t version = parse_numbers(header, "format", 1)[0];
  if (version != format_version) {
    throw Error(
        fmt::format("{}format {}: this program reads {}", key_prefix, version, format_version));
  }
}

Checkpoint read(const Image& image, ImageMetadata header) {
  check_format(header);
  const Window window = window_in(parse_numbers(header, "window", 4));
  if (static_cast<int>(window.width) != image.width ||
      static_cast<int>(window.height) != image.height) {
    throw Error(fmt::format("{}window of {}x{}: the image has {}x{} pixels", key_prefix,
                            window.width, window.height, image.width, image.height));
  }
  const auto plan = parse_numbers(header, "plan", 3);
  if (plan[0] >> Aovs::size != 0 || plan[1] > 1 || plan[2] > 1) {
    throw Error(fmt::format("{}plan: expected a bit for each of {} layers, and two of 0 or 1",
                            key_prefix, Aovs::size));
  }
  Checkpoint checkpoint{
      ImageFilm(window, {static_cast<std::uint32_t>(plan[0]), plan[1] == 1, plan[2] == 1}), {}};
  ImageFilm& film = checkpoint.film;
  film.parts = parts_in(header, window);
  film.tally = tally_in(header);
  read_layers(image, film);
  if (checksum(film) != parse_numbers(header, "checksum", 1)[0]) {
    throw Error(
        fmt::format("{}checksum: the sums are not those that were written; the file is "
                    "damaged",
                    key_prefix));
  }
  std::erase_if(header, [](const auto& entry) { return entry.first.starts_with(key_prefix); });
  checkpoint.metadata = std::move(header);
  return checkpoint;
}

}  // namespace

void write_checkpoint(const std::string& path, const Checkpoint& checkpoint,
                      const PixelFilter& filter, ImagePlace image_size) {
  const ImageFilm& film = checkpoint.film;
  Image image = develop(film, filter);
  image.place = image_size;
  if (image_size.width > 0) {
    image.place.x = static_cast<int>(film.window.x),
    image.place.y = static_cast<int>(film.window.y);
  }
  add_layers(film, image);
  image.is_compressed = false;  // the sums' lower halves are noise: a fifth would be saved
  ImageMetadata header = checkpoint.metadata;
  add_header(film, header);
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
