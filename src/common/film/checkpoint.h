// A checkpoint: the film of an unfinished, or finished, render in an ordinary OpenEXR file. R, G, B
// and the layers of AOVs are the image so far, which any viewer shows. The film's sums, bit by bit,
// are further layers, and the header says which windows have which samples (docs/checkpoints.md).
#pragma once

#include <string>

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

}  // namespace pt
