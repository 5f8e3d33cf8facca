#include <nlohmann/json.hpp>

#include "app/options/option_list.h"
#include "app/report/report.h"
#include "common/options/option_names.h"
#include "common/platform/build_info.h"

namespace pt {
namespace {

using Json = nlohmann::ordered_json;  // fields stay in the order in which a reader wants them

Json program_json() {
  const BuildInfo& build = build_info();
  return {{"name", "ptexp"},
          {"version", build.version},
          {"commit", build.commit},
          {"build_type", build.build_type},
          {"compiler", build.compiler},
          {"cuda", build.cuda},
          {"fast_math", build.fast_math}};
}

Json option_json(const OptionEntry& entry, const Options& options) {
  const std::string text = entry.text(options);
  if (entry.form == OptionForm::flag) return text == "on";
  if (text.empty()) return nullptr;
  if (entry.form != OptionForm::number) return text;
  const Json number = Json::parse(text, nullptr, false);
  return number.is_number() ? number : Json(text);
}

Json options_json(const Options& options) {
  Json json;
  for (const OptionEntry& entry : option_list())
    json[option_key(entry)] = option_json(entry, options);
  return json;
}

Json plan_json(const std::vector<Decision>& decisions) {
  Json json = Json::array();
  for (const Decision& d : decisions)
    json.push_back({{"option", d.option}, {"value", d.value}, {"reason", d.reason}});
  return json;
}

Json spread_json(const Spread& spread) {
  return {{"median", spread.median}, {"min", spread.min}, {"max", spread.max}};
}

Json stages_json(const RunSummary& summary) {
  Json json = Json::array();
  for (const StageSummary& stage : summary.stages)
    json.push_back({{"stage", stage.stage},
                    {"time_ms", spread_json(stage.time_ms)},
                    {"launches", stage.launches}});
  return json;
}

Json number_or_null(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

/// By the names of the CSV's columns, which begin with mlt_.
Json metropolis_json(const std::optional<MetropolisStats>& stats) {
  if (!stats) return nullptr;
  return {{"chains", stats->chains},
          {"mutations", stats->mutations},
          {"bootstrap", stats->bootstrap},
          {"brightness", stats->brightness},
          {"brightness_error", stats->brightness_error},
          {"large_share", stats->large_share},
          {"large_acceptance", stats->large_acceptance},
          {"small_acceptance", stats->small_acceptance},
          {"bootstrap_ms", stats->bootstrap_ms},
          {"mmutations_per_s", 1e-6 * stats->mutations_per_s}};
}

Json runs_json(const RenderReport& report) {
  Json json = Json::array();
  for (const RenderRun& run : report.runs) {
    Json stages = Json::array();
    for (const StageTime& time : run.stages)
      stages.push_back(
          {{"stage", time.stage}, {"time_ms", time.time_ms}, {"launches", time.launches}});
    Json devices = Json::array();
    for (const DeviceShare& device : run.devices)
      devices.push_back({{"name", device.name},
                         {"units", device.units},
                         {"samples", device.samples},
                         {"kernel_ms", device.kernel_ms},
                         {"wall_ms", device.wall_ms}});
    json.push_back({{"kernel_ms", run.kernel_ms},
                    {"wall_ms", run.wall_ms},
                    {"devices", devices},
                    {"waves", run.waves},
                    {"samples_done", run.samples_done},
                    {"ended_by", to_string(run.ended_by)},
                    {"relative_error", number_or_null(run.relative_error)},
                    {"metropolis", metropolis_json(run.metropolis)},
                    {"stages", stages}});
  }
  return json;
}

Json kernels_json(const RenderReport& report) {
  Json json = Json::array();
  for (const KernelInfo& kernel : report.kernels)
    json.push_back({{"name", kernel.name},
                    {"registers", kernel.registers},
                    {"spill_bytes", kernel.spill_bytes},
                    {"shared_bytes", kernel.shared_bytes},
                    {"block_threads", kernel.block_threads},
                    {"occupancy", kernel.occupancy}});
  return json;
}

void add_counter_fields(Json& json, const KernelCounters& kernel, int warps_per_sm) {
  for (const auto& [name, value] : counter_fields(kernel, warps_per_sm)) json[name] = value;
}

Json counted_kernels_json(const HardwareCounters& counters) {
  Json json = Json::array();
  for (const KernelCounters& kernel : sum_by_kernel(counters.launches)) {
    Json entry{{"kernel", kernel.kernel}, {"launches", kernel.launches}};
    add_counter_fields(entry, kernel, counters.warps_per_sm);
    json.push_back(entry);
  }
  return json;
}

Json counted_launches_json(const HardwareCounters& counters) {
  Json json = Json::array();
  for (const LaunchCounters& launch : counters.launches) {
    Json entry{{"kernel", launch.kernel},
               {"wave", launch.wave >= 0 ? Json(launch.wave) : Json(nullptr)}};
    for (std::size_t i = 0; i < launch.values.size(); ++i) {
      entry[counter_table[i].name] = launch.values[i];
    }
    entry["predicted_read_bytes"] = launch.predicted.read;
    entry["predicted_written_bytes"] = launch.predicted.written;
    json.push_back(entry);
  }
  return json;
}

Json counters_json(const std::optional<HardwareCounters>& counters) {
  if (!counters) return nullptr;
  if (!counters->problem.empty()) return {{"problem", counters->problem}};
  Json total = Json::object();
  add_counter_fields(total, sum_all(counters->launches), counters->warps_per_sm);
  return {{"problem", nullptr},
          {"samples", counters->samples},
          {"rays", counters->rays},
          {"passes", counters->passes},
          {"warps_per_sm", counters->warps_per_sm},
          {"uncounted_launches", counters->uncounted_launches},
          {"total", total},
          {"kernels", counted_kernels_json(*counters)},
          {"launches", counted_launches_json(*counters)}};
}

Json divergence_json(const RenderReport& report) {
  Json json = Json::array();
  for (const LaneHistogram& histogram : report.divergence)
    json.push_back(
        {{"point", histogram.point}, {"bounce", histogram.bounce}, {"lanes", histogram.groups}});
  return json;
}

Json memory_json(const RenderReport& report) {
  Json buffers = Json::array();
  for (const BufferSize& buffer : report.memory)
    buffers.push_back({{"name", buffer.name}, {"size_bytes", buffer.size_bytes}});
  return {{"total_bytes", memory_bytes(report)}, {"buffers", buffers}};
}

Json counts_json(const PathCounts& counts) {
  return {{"paths", counts.paths},
          {"rays", counts.rays},
          {"shadow_rays", counts.shadow_rays},
          {"nonfinite_samples", counts.nonfinite_samples},
          {"live_paths", counts.live_paths}};
}

Json scene_json(const SceneFacts& facts) {
  Json memory = Json::object();
  for (const BufferSize& buffer : facts.memory) memory[buffer.name] = buffer.size_bytes;
  return {{"triangles", facts.triangles},
          {"meshes", facts.meshes},
          {"instances", facts.instances},
          {"spheres", facts.spheres},
          {"quads", facts.quads},
          {"materials", facts.materials},
          {"textures", facts.textures},
          {"lights", facts.lights},
          {"memory_bytes", memory},
          {"builder", facts.tree.builder},
          {"tree_nodes", facts.tree.nodes},
          {"tree_references", facts.tree.references},
          {"tree_depth", facts.tree.depth},
          {"sah_cost", facts.tree.sah_cost},
          {"bytes_per_triangle", facts.tree.bytes_per_triangle},
          {"build_ms", facts.tree.build_ms}};
}

}  // namespace

std::string report_json(const Options& options, const RenderReport& report) {
  const RunSummary summary = summarize(report);
  Json json;
  json["schema_version"] = report_schema_version;
  json["program"] = program_json();
  json["options"] = options_json(options);
  json["device"] = {
      {"name", report.device_name}, {"kind", report.device_kind}, {"driver", report.driver}};
  json["used"] = {{"mode", report.mode},
                  {"accel", report.accel},
                  {"schedule", report.schedule},
                  {"stages", report.stages},
                  {"pool_size", report.pool_size},
                  {"finish_paths", report.finish_paths},
                  {"primitives", report.primitives},
                  {"calibration", report.calibration},
                  {"exposure", report.exposure ? Json(*report.exposure) : Json(nullptr)}};
  if (report.optix) {
    json["optix"] = {{"build_ms", report.optix->build_ms},
                     {"bytes_built", report.optix->bytes_built},
                     {"bytes_compacted", report.optix->bytes_compacted},
                     {"rtcore_version", report.optix->rtcore_version},
                     {"reorders", report.optix->reorders}};
  }
  json["plan"] = plan_json(report.plan);
  json["scene"] = scene_json(report.scene);
  json["complete"] = is_complete(options, report);
  json["samples_done"] = summary.samples_done;
  json["ended_by"] = to_string(summary.ended_by);
  json["relative_error"] = number_or_null(summary.relative_error);
  json["metropolis"] = metropolis_json(summary.metropolis);
  json["time_ms"] = {{"kernel", spread_json(summary.kernel_ms)},
                     {"wall", spread_json(summary.wall_ms)},
                     {"scene", report.scene_ms},
                     {"setup", report.setup_ms},
                     {"load", report.load_ms},
                     {"transfer", report.transfer_ms},
                     {"image_write", report.image_write_ms}};
  Json& process = json["process_ms"];
  for (const auto& [name, part] : process_parts) process[name] = report.process_ms.*part;
  process["total"] = report.process_ms.total();
  json["rates"] = {{"mpaths_per_s", summary.mpaths_per_s}, {"mrays_per_s", summary.mrays_per_s}};
  json["waves"] = summary.waves;
  json["launches"] = summary.launches;
  json["stages"] = stages_json(summary);
  json["counts"] = counts_json(report.counts);
  json["memory"] = memory_json(report);
  json["kernels"] = kernels_json(report);
  json["counters"] = counters_json(report.counters);
  if (!report.divergence.empty()) json["divergence"] = divergence_json(report);
  json["runs"] = runs_json(report);
  // A device's or file's name may hold bytes that are not UTF-8: no reason to lose the rest.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace pt
