#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <charconv>
#include <span>

#include "common/error/error.h"
#include "common/film/checkpoint.h"

namespace pt {
namespace {

constexpr int format_version = 1;
using Numbers = std::vector<std::uint64_t>;

std::string key_of(std::string_view name) { return std::string(film_key) + std::string(name); }

const std::string& text_of(const ImageMetadata& header, std::string_view name) {
  const auto found = header.find(key_of(name));
  if (found == header.end()) throw Error(fmt::format("no attribute {}", key_of(name)));
  return found->second;
}

Numbers parse_numbers(const ImageMetadata& header, std::string_view name) {
  const std::string& text = text_of(header, name);
  Numbers numbers;
  for (const char *at = text.data(), *end = at + text.size(); at < end;) {
    const auto [stop, error] = std::from_chars(at, end, numbers.emplace_back());
    if (error != std::errc() || (stop != end && *stop != ' ')) {
      throw Error(fmt::format("{} {}: expected whole numbers", key_of(name), text.substr(0, 80)));
    }
    at = stop == end ? end : stop + 1;
  }
  return numbers;
}

/// The same, of so many.
Numbers parse_numbers(const ImageMetadata& header, std::string_view name, std::size_t count) {
  Numbers numbers = parse_numbers(header, name);
  if (numbers.size() == count) return numbers;
  throw Error(
      fmt::format("{}: expected {} numbers, found {}", key_of(name), count, numbers.size()));
}

void check_format(const ImageMetadata& header) {
  if (!header.contains(key_of("format"))) {
    throw Error(fmt::format("no attribute {}; expected a checkpoint, which --checkpoint writes",
                            key_of("format")));
  }
  const std::uint64_t version = parse_numbers(header, "format", 1)[0];
  if (version != format_version) {
    throw Error(
        fmt::format("{} {}: this program reads {}", key_of("format"), version, format_version));
  }
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

// By their names: an AOV's bit may be another one in another program.
std::string aov_names(std::uint32_t aovs) {
  std::string names;
  for (const AovInfo& info : aov_table) {
    if ((aovs & info.bit) == 0) continue;
    names += (names.empty() ? "" : ",") + std::string(info.name);
  }
  return names;
}

std::uint32_t aovs_in(const ImageMetadata& header) {
  const std::string& text = text_of(header, "aovs");
  std::uint32_t aovs = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view name = rest.substr(0, rest.find(','));
    const auto found = std::ranges::find(aov_table, name, &AovInfo::name);
    if (found == aov_table.end()) {
      throw Error(fmt::format("{}: no layer '{}' in this program", key_of("aovs"), name));
    }
    aovs |= found->bit;
    rest.remove_prefix(std::min(name.size() + 1, rest.size()));
  }
  return aovs;
}

FilmPlan plan_in(const ImageMetadata& header) {
  const Numbers numbers = parse_numbers(header, "plan", 2);
  if (numbers[0] > 1 || numbers[1] > 1)
    throw Error(fmt::format("{}: expected two numbers, 0 or 1", key_of("plan")));
  const FilmPlan plan{aovs_in(header), numbers[0] == 1, numbers[1] == 1};
  if (needs_moments(plan.aovs) && !plan.moments) {
    throw Error(fmt::format("{}: expected moments, which the layers {} are made of", key_of("plan"),
                            aov_names(plan.aovs)));
  }
  return plan;
}

/// Pixels that a window has taken, so that no other one may.
class TakenPixels {
 public:
  explicit TakenPixels(const Window& image) : image_(image), taken_(image.pixel_count()) {}

  /// False where one is outside of the image or not free.
  bool take(const Window& part) {
    if (!image_.contains(part)) return false;
    for (std::uint32_t y = part.y - image_.y; y < part.y - image_.y + part.height; ++y) {
      const auto row = taken_.begin() + static_cast<std::ptrdiff_t>(
                                            std::uint64_t{y} * image_.width + part.x - image_.x);
      if (std::find(row, row + part.width, true) != row + part.width) return false;
      std::fill_n(row, part.width, true);
    }
    return true;
  }

 private:
  Window image_;
  std::vector<bool> taken_;
};

std::vector<FilmPart> parts_in(const ImageMetadata& header, const Window& window) {
  const Numbers numbers = parse_numbers(header, "parts");
  constexpr std::size_t fields = 6;
  if (numbers.size() % fields != 0) {
    throw Error(
        fmt::format("{}: expected x y width height first_sample next_sample of each, "
                    "found {} numbers",
                    key_of("parts"), numbers.size()));
  }
  TakenPixels taken(window);
  std::vector<FilmPart> parts;
  for (std::size_t i = 0; i < numbers.size(); i += fields) {
    FilmPart part{window_in(std::span(numbers).subspan(i, 4)), 0, 0};
    const std::uint64_t first = numbers[i + 4], next = numbers[i + 5];
    part.first_sample = static_cast<std::uint32_t>(first);
    part.next_sample = static_cast<std::uint32_t>(next);
    if (first > next || next > UINT32_MAX || part.window.pixel_count() == 0 ||
        !taken.take(part.window)) {
      throw Error(fmt::format(
          "{}: expected disjoint windows of the image, with samples that ascend", key_of("parts")));
    }
    parts.push_back(part);
  }
  return parts;
}

PathTally tally_in(const ImageMetadata& header) {
  const Numbers numbers = parse_numbers(header, "tally", 3 + path_length_bins);
  PathTally tally;
  tally.rays = numbers[0], tally.shadow_rays = numbers[1], tally.nonfinite = numbers[2];
  std::copy(numbers.begin() + 3, numbers.end(), std::begin(tally.lengths));
  return tally;
}

template <class T>
void add_checksum(const std::vector<T>& values, std::uint32_t& sum) {
  if (values.empty()) return;  // zlib starts again where it is given no bytes
  const auto* const bytes = reinterpret_cast<const Bytef*>(values.data());
  sum = static_cast<std::uint32_t>(crc32_z(sum, bytes, values.size() * sizeof(T)));
}

/// The CRC-32 of the names and values of all attributes but itself, each with its final zero byte.
std::uint32_t header_checksum(const ImageMetadata& header) {
  uLong sum = 0;
  for (const auto& [name, value] : header) {
    if (name == key_of("header_checksum")) continue;
    for (const std::string* text : {&name, &value}) {
      sum = crc32_z(sum, reinterpret_cast<const Bytef*>(text->c_str()), text->size() + 1);
    }
  }
  return static_cast<std::uint32_t>(sum);
}

}  // namespace

std::uint32_t checksum(const FilmSums& sums) {
  static_assert(sizeof(FilmPixel) == 32 && sizeof(PixelMoments) == 24);  // no padding
  std::uint32_t sum = 0;
  add_checksum(sums.pixels, sum);
  add_checksum(sums.moments, sum);
  add_checksum(sums.features, sum);
  return sum;
}

void add_film_header(const ImageFilm& film, ImageMetadata& header) {
  const auto add = [&](const char* name, const Numbers& numbers) {
    header[key_of(name)] = fmt::format("{}", fmt::join(numbers, " "));
  };
  add("format", {format_version});
  add("window", {film.window.x, film.window.y, film.window.width, film.window.height});
  header[key_of("aovs")] = aov_names(film.plan.aovs);
  add("plan", {film.plan.moments, film.plan.two_signs});
  Numbers parts;
  for (const FilmPart& part : film.parts) {
    const Window& w = part.window;
    for (const std::uint32_t n : {w.x, w.y, w.width, w.height, part.first_sample, part.next_sample})
      parts.push_back(n);
  }
  add("parts", parts);
  const PathTally& tally = film.tally;
  Numbers counts{tally.rays, tally.shadow_rays, tally.nonfinite};
  counts.insert(counts.end(), std::begin(tally.lengths), std::end(tally.lengths));
  add("tally", counts);
  add("checksum", {checksum(film)});
  add("header_checksum", {header_checksum(header)});
}

FilmHeader parse_film_header(const ImageMetadata& header, int width, int height) {
  check_format(header);
  FilmHeader film;
  const Window& window = film.window = window_in(parse_numbers(header, "window", 4));
  if (static_cast<int>(window.width) != width || static_cast<int>(window.height) != height) {
    throw Error(fmt::format("{} of {}x{}: the image has {}x{} pixels", key_of("window"),
                            window.width, window.height, width, height));
  }
  film.plan = plan_in(header);
  film.parts = parts_in(header, film.window);
  film.tally = tally_in(header);
  const std::uint64_t sum = parse_numbers(header, "checksum", 1)[0];
  if (sum > UINT32_MAX) {
    throw Error(fmt::format("{}: expected a number of 32 bits", key_of("checksum")));
  }
  film.checksum = static_cast<std::uint32_t>(sum);
  return film;
}

void check_header_checksum(const ImageMetadata& header) {
  if (header_checksum(header) == parse_numbers(header, "header_checksum", 1)[0]) return;
  throw Error(fmt::format("{}: the attributes are not those that were written; the file is damaged",
                          key_of("header_checksum")));
}

}  // namespace pt
