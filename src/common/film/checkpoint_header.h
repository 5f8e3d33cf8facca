// What the header of a checkpoint says of its film: attributes of the EXR.
#pragma once

#include <string_view>

#include "common/film/image_film.h"
#include "common/image/codecs/image_io.h"

namespace pt {

/// Keys that begin so are the checkpoint's own.
inline constexpr std::string_view film_key = "ptexp.film.";

/// A film but for its sums.
struct FilmHeader {
  Window window;
  FilmPlan plan;
  std::vector<FilmPart> parts;
  PathTally tally;
  std::uint32_t checksum = 0;  ///< of the sums
};

/// CRC-32 of all sums.
std::uint32_t checksum(const FilmSums& sums);

/// Adds the film's attributes, and then a checksum of all attributes.
void add_film_header(const ImageFilm& film, ImageMetadata& header);

/// Throws Error, naming the attribute, unless all are there and fit each other and an image of so
/// many pixels.
FilmHeader parse_film_header(const ImageMetadata& header, int width, int height);

/// Throws Error where an attribute, of the film or of the caller, is not as it was written.
void check_header_checksum(const ImageMetadata& header);

}  // namespace pt
