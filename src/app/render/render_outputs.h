// The outputs of a render: the image and the files of statistics.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/report/report.h"
#include "common/image/codecs/image_io.h"
#include "common/render/renderer.h"

namespace pt {

/// Throws Error if a file that the options name could not be written.
void check_outputs(const Options& options, bool writes_image = true);

struct Exposure {
  float stops = 0;
  bool is_measured = false;
};

/// The exposure of an image of this format; none for an .exr, which holds radiance. If `exposure`
/// leaves it to the scene, it is measured for a .png if `by_default`.
std::optional<Exposure> exposure_for(const std::string& path, const ExposureChoice& exposure,
                                     const Image& image, bool by_default);

/// A warning about a black image; empty if it shows something or is a part.
std::string black_image_text(const Options& options, const Image& image);

/// Reads the hardware's counters. A failure is a warning, so that the image is not lost.
HardwareCounters count_hardware(Renderer& renderer,
                                const std::function<void(const std::string&)>& warn);

/// Several actions that are all tried, even if one fails.
class Attempts {
 public:
  /// Returns false if `action` throws. `advice` is appended to the message.
  bool make(const std::function<void()>& action, const std::string& advice = "");
  /// Throws one Error with all messages.
  void check() const;

 private:
  std::vector<std::string> problems_;
};

/// Writes the files of statistics that the options name; a CSV row for complete runs only.
void write_statistics(const Options& options, const RenderReport& report, Attempts& attempts);

/// Throws Error if an output would replace a file that the scene was read from.
void check_not_of_scene(const Options& options, const std::vector<std::string>& source_files);

}  // namespace pt
