// The header of an image tells how it was made, so that it can be continued, merged and verified.
#pragma once

#include <string>
#include <vector>

#include "app/options/option_list.h"
#include "common/image/codecs/image_io.h"
#include "common/options/stats.h"

namespace pt {

/// Raised whenever the same options give other bits than before.
inline constexpr int film_version = 1;

/// All options, the program's version, the scene's hash, and the kind of device ("cpu" or "cuda",
/// whose bits differ).
ImageMetadata film_header(const Options& options, const std::string& scene_hash,
                          const std::string& device_kind);

/// The same with device, build, counts and times of a render, for its image.
ImageMetadata image_header(const Options& options, const RenderReport& report,
                           const std::string& scene_hash);

/// The options in the header of `file`. Throws Error where the header has none, is of another
/// version, or names an option that this program does not have.
Options options_in_header(const ImageMetadata& header, const std::string& file);

/// Throws Error, naming both files and what differs, unless the samples of both are of one render.
void check_same_render(const ImageMetadata& a, const std::string& file_a, const ImageMetadata& b,
                       const std::string& file_b);

/// Changes `options` of `file` by these settings. Throws Error for one that gives other samples.
void apply_settings(const std::vector<Setting>& settings, const std::string& file,
                    Options& options);

}  // namespace pt
