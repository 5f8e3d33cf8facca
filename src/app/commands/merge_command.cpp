#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <set>
#include <span>

#include "app/commands/commands.h"
#include "app/report/film_header.h"
#include "common/error/error.h"
#include "common/error/terminal.h"
#include "common/film/checkpoint.h"
#include "common/film/develop.h"
#include "common/image/atomic_file.h"
#include "common/image/tone_mapping.h"
#include "common/scene/prepare/prepare_filter.h"

namespace pt {
namespace {

std::string pixels_of(const Window& w) {
  return fmt::format("{}x{} pixels at {},{}", w.width, w.height, w.x, w.y);
}

PixelFilter filter_by(const Options& options) {
  SceneData holder;
  prepare_filter(holder, options.filter.value_or(FilterChoice{}));
  return holder.filter;
}

/// Merges the films of several files.
class Joiner {
 public:
  void add(const std::string& file) {
    Checkpoint checkpoint = read_checkpoint(file);
    options_in_header(checkpoint.metadata, file);  // refuses other versions
    if (film_) {
      check_same_render(header_, files_.front(), checkpoint.metadata, file);
      check_same_size(checkpoint.film, file);
    } else {
      header_ = checkpoint.metadata;
      film_ = ImageFilm(checkpoint.film.window, checkpoint.film.plan);
    }
    files_.push_back(file);
    headers_.push_back(checkpoint.metadata);
    for (const FilmPart& part : checkpoint.film.parts) add_part(checkpoint.film, part);
    film_->tally = film_->tally + checkpoint.film.tally;
  }

  const ImageFilm& film() const { return *film_; }
  const ImageMetadata& header() const { return header_; }

  /// The numbers N of --part N/M that have no file; empty if M differs between the files.
  std::vector<int> missing_parts() const {
    std::set<int> present;
    int count = 1;
    for (std::size_t i = 0; i < headers_.size(); ++i) {
      const Options options = options_in_header(headers_[i], files_[i]);
      if (i > 0 && options.part.count != count) return {};
      count = options.part.count;
      present.insert(options.part.index);
    }
    std::vector<int> missing;
    for (int i = 1; i <= count; ++i) {
      if (!present.contains(i)) missing.push_back(i);
    }
    return missing;
  }

 private:
  struct Origin {
    Window window;
    std::size_t file;
  };

  void check_same_size(const ImageFilm& film, const std::string& file) const {
    if (film.window == film_->window && film.plan == film_->plan) return;
    throw Error(fmt::format("{}: is of {}, with other sums than {}, of {}", file,
                            pixels_of(film.window), files_.front(), pixels_of(film_->window)));
  }

  void add_part(const ImageFilm& film, const FilmPart& part) {
    std::vector<Window> fresh{part.window};
    for (const Origin& origin : origins_) {
      const Window common = intersect(origin.window, part.window);
      if (common.pixel_count() == 0) continue;
      check_equal(film, common, origin);
      std::vector<Window> rest;
      for (const Window& w : fresh) std::ranges::move(subtract(w, common), back_inserter(rest));
      fresh = std::move(rest);
    }
    for (const Window& w : fresh) {
      film_->put(film.take(w));
      origins_.push_back({w, files_.size() - 1});
    }
  }

  /// Throws Error unless two files have the same samples and bits of their common pixels.
  void check_equal(const ImageFilm& film, const Window& window, const Origin& origin) const {
    const Film ours = film_->take(window), theirs = film.take(window);
    const std::string &a = files_[origin.file], &b = files_.back();
    if (ours.first_sample != theirs.first_sample || ours.next_sample != theirs.next_sample) {
      throw Error(
          fmt::format("{}: has {} samples of {}, but {} has {}; ptexp resume goes on with "
                      "the one that has fewer",
                      b, theirs.next_sample - theirs.first_sample, pixels_of(window), a,
                      ours.next_sample - ours.first_sample));
    }
    for (std::size_t i = 0; i < ours.pixels.size(); ++i) {
      if (std::memcmp(&ours.pixels[i], &theirs.pixels[i], sizeof(FilmPixel)) == 0) continue;
      const std::uint64_t pixel = i % window.pixel_count();
      throw Error(
          fmt::format("pixel {},{}: differs between {} and {}, both of {} samples; one of "
                      "the devices that rendered them computes wrongly",
                      window.x + pixel % window.width, window.y + pixel / window.width, a, b,
                      ours.next_sample - ours.first_sample));
    }
    const auto differ = [](const auto& x, const auto& y) {
      const auto ours_bytes = std::as_bytes(std::span(x)),
                 theirs_bytes = std::as_bytes(std::span(y));
      return !std::ranges::equal(ours_bytes, theirs_bytes);
    };
    if (differ(ours.moments, theirs.moments) || differ(ours.features, theirs.features)) {
      throw Error(fmt::format("{}: other layers than in {} of {}", b, a, pixels_of(window)));
    }
  }

  std::optional<ImageFilm> film_;
  ImageMetadata header_;
  std::vector<std::string> files_;
  std::vector<ImageMetadata> headers_;
  std::vector<Origin> origins_;
};

/// Fraction of the samples that is missing.
double missing_share(const ImageFilm& film, int spp) {
  const double wanted = static_cast<double>(film.window.pixel_count()) * spp;
  return 1.0 - static_cast<double>(film.samples()) / wanted;
}

void check_whole(const Joiner& joiner, int spp, bool allow_missing) {
  const auto lacking = joiner.film().lacking(joiner.film().window, static_cast<std::uint32_t>(spp));
  if (lacking.empty()) return;
  const std::vector<int> parts = joiner.missing_parts();
  const std::string which =
      parts.empty() ? fmt::format("{} have {} of {} samples", pixels_of(lacking[0].window),
                                  lacking[0].next_sample - lacking[0].first_sample, spp)
                    : fmt::format("no file of --part {}", fmt::join(parts, ", "));
  const double percent = 100 * missing_share(joiner.film(), spp);
  if (!allow_missing) {
    throw Error(
        fmt::format("{}: {:.3g} % of the samples are missing; --allow-missing writes an "
                    "image without them",
                    which, percent));
  }
  print_warning(fmt::format("{}: {:.3g} % of the samples are missing", which, percent));
}

}  // namespace

int merge_command(const MergeCommand& command) {
  check_image_path(command.output);
  for (const std::string& input : command.inputs) check_not_read("merge", command.output, input);
  Joiner joiner;
  for (const std::string& file : command.inputs) joiner.add(file);
  ImageMetadata header = joiner.header();
  header.erase("ptexp.option.part");
  const Options options = options_in_header(header, command.inputs.front());
  check_whole(joiner, options.spp, command.allow_missing);
  const PixelFilter filter = filter_by(options);
  if (command.keeps_sums) {
    write_checkpoint(command.output, {joiner.film(), header}, filter,
                     {0, 0, options.width, options.height});
  } else {
    Image image = develop(joiner.film(), filter);
    const Window& window = joiner.film().window;
    image.place = {static_cast<int>(window.x), static_cast<int>(window.y), options.width,
                   options.height};
    const float stops = options.exposure.kind == ExposureChoice::Kind::measured
                            ? measure_exposure(image)
                            : options.exposure.stops;
    header["ptexp.samples_done"] = std::to_string(joiner.film().least_samples());
    write_image(command.output, image, header, {stops});
  }
  print("wrote {}, of {} file{}\n", command.output, command.inputs.size(),
        command.inputs.size() == 1 ? "" : "s");
  return 0;
}

}  // namespace pt
