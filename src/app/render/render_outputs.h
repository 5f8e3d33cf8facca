// What a render leaves behind: its image, and the statistics beside it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/report/report.h"
#include "common/image/codecs/image_io.h"
#include "common/render/renderer.h"

namespace pt {

/// Throws Error where one of the files that the options name could not be written.
void check_outputs(const Options& options);

struct Exposure {
  float stops = 0;
  bool is_measured = false;
};

/// Of an image of this format; none where it has a place for radiance (.exr). What `exposure`
/// leaves open is measured in a .png if `by_default`.
std::optional<Exposure> exposure_for(const std::string& path, const ExposureChoice& exposure,
                                     const Image& image, bool by_default);

/// What is said of an image that shows nothing; empty: it shows something, or is a part.
std::string black_image_text(const Options& options, const Image& image);

/// Options, device, times, and what makes an image one that can be verified.
ImageMetadata image_header(const Options& options, const RenderReport& report,
                           const std::string& scene_hash);

/// Reads the hardware's counters. What could not be counted is no reason to lose what was rendered:
/// it is a warning.
HardwareCounters count_hardware(Renderer& renderer,
                                const std::function<void(const std::string&)>& warn);

/// Several things that should all be done: what one fails at keeps no other from being tried.
class Attempts {
 public:
  /// False where `action` has thrown. `advice` follows the message of what it has thrown.
  bool make(const std::function<void()>& action, const std::string& advice = "");
  /// Throws one Error for all that has failed.
  void check() const;

 private:
  std::vector<std::string> problems_;
};

/// The files of statistics that the options name. CSV rows are for comparing: complete runs only.
void write_statistics(const Options& options, const RenderReport& report, Attempts& attempts);

/// Throws Error where an output would replace a file that the scene was read from.
void check_not_of_scene(const Options& options, const std::vector<std::string>& source_files);

}  // namespace pt
