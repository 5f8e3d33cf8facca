// What an image's header says of how it was made, so that it can be continued, joined and verified.
#pragma once

#include <string>
#include <vector>

#include "app/options/option_list.h"
#include "common/image/codecs/image_io.h"

namespace pt {

/// Raised whenever the same options give other bits than before.
inline constexpr int film_version = 1;

/// All options, the program's version, the scene's hash, and "cpu" or "cuda", whose bits differ.
ImageMetadata film_header(const Options& options, const std::string& scene_hash,
                          const std::string& device_kind);

/// The options in the header of `file`. Throws Error where one is missing, or is none of this
/// program's.
Options options_in_header(const ImageMetadata& header, const std::string& file);

/// Throws Error, naming both files and what differs, unless the samples of both are of one render.
void check_same_render(const ImageMetadata& a, const std::string& file_a, const ImageMetadata& b,
                       const std::string& file_b);

/// Changes `options` of `file` by these settings. Throws Error for one that means other samples.
void apply_settings(const std::vector<Setting>& settings, const std::string& file,
                    Options& options);

}  // namespace pt
