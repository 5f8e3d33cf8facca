#include <fmt/format.h>

#include "app/options/option_list.h"
#include "app/report/report.h"
#include "app/report/run_summary.h"
#include "common/options/option_names.h"
#include "common/platform/build_info.h"

namespace pt {

std::map<std::string, std::string> report_metadata(const Options& options,
                                                   const RenderReport& report) {
  const BuildInfo& build = build_info();
  const RunSummary summary = summarize(report);
  std::map<std::string, std::string> metadata{
      {"ptexp.version", build.version},
      {"ptexp.commit", build.commit},
      {"ptexp.build", fmt::format("{}, {}, CUDA {}{}", build.build_type, build.compiler, build.cuda,
                                  build.fast_math ? ", fast math" : "")},
      {"ptexp.device", report.device_name},
      {"ptexp.samples_done", std::to_string(summary.samples_done)},
      {"ptexp.ended_by", to_string(summary.ended_by)},
      {"ptexp.paths", std::to_string(report.counts.paths)},
      {"ptexp.rays", std::to_string(report.counts.rays)},
      {"ptexp.kernel_ms", fmt::format("{:.6f}", summary.kernel_ms.median)},
      {"ptexp.scene_ms", fmt::format("{:.6f}", report.scene_ms)},
      {"ptexp.setup_ms", fmt::format("{:.6f}", report.setup_ms)},
      {"ptexp.load_ms", fmt::format("{:.6f}", report.load_ms)},
      {"ptexp.transfer_ms", fmt::format("{:.6f}", report.transfer_ms)}};
  if (summary.relative_error) {
    metadata["ptexp.relative_error"] = fmt::format("{:.6g}", *summary.relative_error);
  }
  if (report.exposure) metadata["ptexp.exposure"] = fmt::format("{}", *report.exposure);
  // An option that the scene decides is left out: an empty attribute would look like a value.
  for (const OptionEntry& entry : option_list())
    if (const std::string text = entry.text(options); !text.empty())
      metadata["ptexp.option." + option_key(entry)] = text;
  return metadata;
}

}  // namespace pt
