#include <fmt/format.h>

#include <cmath>

#include "app/options/option_list.h"
#include "app/report/csv_file.h"
#include "app/report/report.h"
#include "common/options/option_names.h"

namespace pt {
namespace {

/// The stages that have columns of their own; others are summed as "other".
std::vector<std::string> column_stages() {
  std::vector<std::string> names;
  for (const StageInfo& stage : stage_table) names.emplace_back(stage.name);
  return names;
}

std::string ms(double time_ms) { return fmt::format("{:.6f}", time_ms); }  // to a nanosecond

template <typename List, typename ToText>
std::string joined(const List& list, ToText to_text) {
  std::string text;
  for (const auto& item : list) text += (text.empty() ? "" : ";") + to_text(item);
  return text;
}

void add_spread(CsvRow& row, const std::string& name, const Spread& spread) {
  row.emplace_back(name + "_ms_median", ms(spread.median));
  row.emplace_back(name + "_ms_min", ms(spread.min));
  row.emplace_back(name + "_ms_max", ms(spread.max));
}

/// Empty fields where the mode has no such stage.
void add_stage(CsvRow& row, const std::string& name, const RunSummary& summary) {
  for (const StageSummary& stage : summary.stages) {
    if (stage.stage != name) continue;
    add_spread(row, name, stage.time_ms);
    row.emplace_back(name + "_launches", std::to_string(stage.launches));
    return;
  }
  for (const char* suffix : {"_ms_median", "_ms_min", "_ms_max", "_launches"})
    row.emplace_back(name + suffix, "");
}

/// The report with all stages that have no columns summed as "other".
RenderReport with_other_stage(const RenderReport& report) {
  const std::vector<std::string> known = column_stages();
  RenderReport renamed = report;
  for (RenderRun& run : renamed.runs) {
    StageTime other{"other"};
    std::erase_if(run.stages, [&](const StageTime& time) {
      if (std::find(known.begin(), known.end(), time.stage) != known.end()) return false;
      other.time_ms += time.time_ms;
      other.launches += time.launches;
      return true;
    });
    if (other.launches > 0 || other.time_ms > 0) run.stages.push_back(other);
  }
  return renamed;
}

void add_counts(CsvRow& row, const PathCounts& counts) {
  row.emplace_back("paths", std::to_string(counts.paths));
  row.emplace_back("rays", std::to_string(counts.rays));
  row.emplace_back("shadow_rays", std::to_string(counts.shadow_rays));
  row.emplace_back("nonfinite_samples", std::to_string(counts.nonfinite_samples));
  row.emplace_back("live_paths", joined(counts.live_paths,
                                        [](std::uint64_t count) { return std::to_string(count); }));
}

void add_device(CsvRow& row, const RenderReport& report) {
  row.emplace_back("device_name", report.device_name);
  row.emplace_back("device_kind", report.device_kind);
  row.emplace_back("driver", report.driver);
  row.emplace_back("used_mode", report.mode);
  row.emplace_back("used_accel", report.accel);
  row.emplace_back("used_schedule", report.schedule);
  row.emplace_back("used_stages", report.stages);
  row.emplace_back("used_pool_size", std::to_string(report.pool_size));
  row.emplace_back("used_finish_paths", std::to_string(report.finish_paths));
  row.emplace_back("primitives", std::to_string(report.primitives));
  row.emplace_back("used_calibration", report.calibration);
  row.emplace_back("used_exposure", report.exposure ? fmt::format("{}", *report.exposure) : "");
}

void add_scene(CsvRow& row, const SceneFacts& facts) {
  row.emplace_back("triangles", std::to_string(facts.triangles));
  row.emplace_back("instances", std::to_string(facts.instances));
  row.emplace_back("lights", std::to_string(facts.lights));
  row.emplace_back("used_builder", facts.tree.builder);
  row.emplace_back("tree_nodes", std::to_string(facts.tree.nodes));
  row.emplace_back("tree_references", std::to_string(facts.tree.references));
  row.emplace_back("sah_cost", fmt::format("{:.6g}", facts.tree.sah_cost));
  row.emplace_back("bytes_per_triangle", fmt::format("{:.6g}", facts.tree.bytes_per_triangle));
  row.emplace_back("build_ms", ms(facts.tree.build_ms));
}

/// As text; empty where there was nothing to divide by.
std::string counted(double value) { return std::isnan(value) ? "" : fmt::format("{:.6g}", value); }

std::string counted_kernels(const HardwareCounters& counters) {
  return joined(sum_by_kernel(counters.launches), [&](const KernelCounters& kernel) {
    std::string text = fmt::format("{}:{}", kernel.kernel, kernel.launches);
    for (const auto& field : counter_fields(kernel, counters.warps_per_sm)) {
      text += ":" + counted(field.second);
    }
    return text;
  });
}

/// Empty fields where nothing was counted.
void add_counters(CsvRow& row, const std::optional<HardwareCounters>& counters) {
  const bool has = counters && counters->problem.empty();
  const HardwareCounters values = has ? *counters : HardwareCounters();
  row.emplace_back("counters_problem", counters ? counters->problem : "");
  row.emplace_back("counted_samples", has ? std::to_string(values.samples) : "");
  row.emplace_back("counted_rays", has ? std::to_string(values.rays) : "");
  for (const auto& [name, value] : counter_fields(sum_all(values.launches), values.warps_per_sm)) {
    row.emplace_back("counted_" + name, has ? counted(value) : "");
  }
  row.emplace_back("counted_kernels", has ? counted_kernels(values) : "");
}

/// Empty fields without --integrator mlt.
void add_metropolis(CsvRow& row, const std::optional<MetropolisStats>& stats) {
  const MetropolisStats s = stats.value_or(MetropolisStats());
  const auto add = [&](const char* name, const std::string& value) {
    row.emplace_back(std::string("mlt_") + name, stats ? value : "");
  };
  add("chains", std::to_string(s.chains));
  add("mutations", std::to_string(s.mutations));
  add("bootstrap", std::to_string(s.bootstrap));
  add("brightness", fmt::format("{:.9g}", s.brightness));
  add("brightness_error", fmt::format("{:.6g}", s.brightness_error));
  add("large_share", fmt::format("{:.6g}", s.large_share));
  add("large_acceptance", fmt::format("{:.6g}", s.large_acceptance));
  add("small_acceptance", fmt::format("{:.6g}", s.small_acceptance));
  add("bootstrap_ms", ms(s.bootstrap_ms));
  add("mmutations_per_s", fmt::format("{:.6g}", 1e-6 * s.mutations_per_s));
}

/// Devices of the last render: "name:units:samples:kernel_ms:wall_ms;..."; empty for one device.
std::string devices_text(const RenderReport& report) {
  if (report.runs.empty()) return "";
  return joined(report.runs.back().devices, [](const DeviceShare& device) {
    return fmt::format("{}:{}:{}:{}:{}", device.name, device.units, device.samples,
                       ms(device.kernel_ms), ms(device.wall_ms));
  });
}

}  // namespace

CsvRow report_csv_row(const Options& options, const RenderReport& report) {
  const RunSummary summary = summarize(with_other_stage(report));
  CsvRow row{{"schema_version", std::to_string(report_schema_version)}};
  for (const auto& column : build_columns()) row.push_back(column);
  for (const OptionEntry& entry : option_list())
    row.emplace_back(option_key(entry), entry.text(options));
  add_device(row, report);
  add_scene(row, report.scene);
  row.emplace_back("samples_done", std::to_string(summary.samples_done));
  row.emplace_back("ended_by", to_string(summary.ended_by));
  row.emplace_back("relative_error",
                   summary.relative_error ? fmt::format("{:.6g}", *summary.relative_error) : "");
  add_metropolis(row, summary.metropolis);
  add_spread(row, "kernel", summary.kernel_ms);
  add_spread(row, "wall", summary.wall_ms);
  row.emplace_back("devices", devices_text(report));
  for (const std::string& stage : column_stages()) add_stage(row, stage, summary);
  add_stage(row, "other", summary);
  row.emplace_back("waves", std::to_string(summary.waves));
  row.emplace_back("launches", std::to_string(summary.launches));
  row.emplace_back("mpaths_per_s", fmt::format("{:.6g}", summary.mpaths_per_s));
  row.emplace_back("mrays_per_s", fmt::format("{:.6g}", summary.mrays_per_s));
  add_counts(row, report.counts);
  row.emplace_back("scene_ms", ms(report.scene_ms));
  row.emplace_back("setup_ms", ms(report.setup_ms));
  row.emplace_back("load_ms", ms(report.load_ms));
  row.emplace_back("transfer_ms", ms(report.transfer_ms));
  row.emplace_back("image_write_ms", ms(report.image_write_ms));
  for (const auto& [name, part] : process_parts)
    row.emplace_back(fmt::format("process_{}_ms", name), ms(report.process_ms.*part));
  row.emplace_back("process_total_ms", ms(report.process_ms.total()));
  row.emplace_back("memory_bytes", std::to_string(memory_bytes(report)));
  row.emplace_back("kernels", joined(report.kernels, [](const KernelInfo& kernel) {
                     return fmt::format("{}:{}:{}:{}:{}:{:.4f}", kernel.name, kernel.registers,
                                        kernel.spill_bytes, kernel.shared_bytes,
                                        kernel.block_threads, kernel.occupancy);
                   }));
  add_counters(row, report.counters);
  return row;
}

}  // namespace pt
