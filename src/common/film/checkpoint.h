// A checkpoint: the film of an unfinished, or finished, render in an ordinary OpenEXR file. R, G, B
// and the layers of AOVs are the image so far, which any viewer shows. The film's sums, bit by bit,
// are further layers, and the header says which windows have which samples (docs/checkpoints.md).
#pragma once

#include <string>
#include <string_view>

#include "common/film/image_film.h"
#include "common/image/codecs/image_io.h"

namespace pt {

struct Checkpoint {
  ImageFilm film;
  ImageMetadata metadata;  ///< of the caller; keys that begin with "ptexp.film." are this file's
};

/// Replaces `path` when the new file is complete. `image_size`: of the whole image where the film
/// is of a crop window. Throws Error naming the file.
void write_checkpoint(const std::string& path, const Checkpoint& checkpoint,
                      const PixelFilter& filter, ImagePlace image_size = {});

/// Throws Error naming the file and what is wrong: no EXR, no checkpoint, one of a newer program,
/// sums that are missing or damaged.
Checkpoint read_checkpoint(const std::string& path);

// The header: attributes of the EXR that describe the film.

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
