#include "app/render/render_outputs.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/report/csv_file.h"
#include "common/error/error.h"
#include "common/error/host_memory.h"
#include "common/image/atomic_file.h"
#include "common/image/tone_mapping.h"

namespace pt {

void check_outputs(const Options& options, bool writes_image) {
  if (writes_image) check_image_path(options.output);
  if (!options.stats_file.empty()) check_writable(options.stats_file);
  if (!options.checkpoint.file.empty()) check_writable(options.checkpoint.file);
  if (!options.csv_file.empty()) check_csv(options.csv_file, report_csv_row(options, {}));
}

std::optional<Exposure> exposure_for(const std::string& path, const ExposureChoice& exposure,
                                     const Image& image, bool by_default) {
  using Kind = ExposureChoice::Kind;
  const std::string ending = image_ending(path);
  if (ending == ".exr") return std::nullopt;
  const bool is_measured = exposure.kind == Kind::measured ||
                           (exposure.kind == Kind::scene && by_default && ending == ".png");
  return Exposure{is_measured ? measure_exposure(image) : exposure.stops, is_measured};
}

std::string black_image_text(const Options& options, const Image& image) {
  constexpr float least = 1e-6f;
  const bool is_part = options.part.count > 1 || options.crop;
  if (options.quiet || is_part ||
      std::ranges::any_of(image.rgb, [](float x) { return !(x < least); }))
    return "";
  return "the image is black: no light of the scene reaches what the camera sees";
}

HardwareCounters count_hardware(Renderer& renderer,
                                const std::function<void(const std::string&)>& warn) {
  try {
    return renderer.count_hardware();
  } catch (const std::exception& error) {
    if (warn) warn(std::string("--counters: ") + error.what());
    HardwareCounters none;
    none.problem = error.what();
    return none;
  }
}

bool Attempts::make(const std::function<void()>& action, const std::string& advice) {
  try {
    action();
    return true;
  } catch (const std::exception& error) {
    problems_.push_back(message_of(error) + advice);
    return false;
  }
}

void Attempts::check() const {
  if (!problems_.empty()) throw Error(fmt::format("{}", fmt::join(problems_, "; ")));
}

void write_statistics(const Options& options, const RenderReport& report, Attempts& attempts) {
  attempts.make([&] {
    if (!options.stats_file.empty())
      write_file_atomically(options.stats_file, report_json(options, report));
  });
  attempts.make([&] {
    if (!options.csv_file.empty() && is_complete(options, report))
      append_csv_row(options.csv_file, report_csv_row(options, report));
  });
}

void check_not_of_scene(const Options& options, const std::vector<std::string>& source_files) {
  for (const std::string& file : source_files) {
    if (options.part.count == 1) check_not_read("--output", options.output, file);
    check_not_read("--stats", options.stats_file, file);
    check_not_read("--csv", options.csv_file, file);
    check_not_read("--checkpoint", options.checkpoint.file, file);
  }
}

}  // namespace pt
