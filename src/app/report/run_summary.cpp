#include <algorithm>
#include <random>

#include "app/report/report.h"

namespace pt {
namespace {

/// The times of `stage` over the repeats in which it ran.
std::vector<double> stage_times(const std::vector<RenderRun>& runs, const std::string& stage) {
  std::vector<double> times;
  for (const RenderRun& run : runs)
    for (const StageTime& time : run.stages)
      if (time.stage == stage) times.push_back(time.time_ms);
  return times;
}

std::vector<StageSummary> summarize_stages(const std::vector<RenderRun>& runs) {
  std::vector<StageSummary> stages;
  for (const RenderRun& run : runs) {
    for (const StageTime& time : run.stages) {
      auto found = std::ranges::find(stages, time.stage, &StageSummary::stage);
      if (found == stages.end()) {
        stages.push_back({time.stage, spread(stage_times(runs, time.stage)), 0});
        found = stages.end() - 1;
      }
      found->launches = time.launches;
    }
  }
  return stages;
}

double millions_per_s(std::uint64_t count, double time_ms) {
  return time_ms > 0 ? static_cast<double>(count) / (1e3 * time_ms) : 0;
}

}  // namespace

Spread spread(std::vector<double> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  const double median =
      values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
  return {median, values.front(), values.back()};
}

std::pair<double, double> bootstrap_interval(
    std::size_t count, std::size_t resamples,
    const std::function<double(std::span<const std::size_t>)>& statistic) {
  std::mt19937 random(20231122);
  std::vector<double> values(resamples);
  std::vector<std::size_t> drawn(count);
  for (double& value : values) {
    for (std::size_t& index : drawn) index = random() % count;
    value = statistic(drawn);
  }
  std::ranges::sort(values);
  return {values[resamples / 40], values[resamples - 1 - resamples / 40]};
}

RunSummary summarize(const RenderReport& report) {
  RunSummary summary;
  std::vector<double> kernel_ms, wall_ms, devices_ms;
  for (const RenderRun& run : report.runs) {
    kernel_ms.push_back(run.kernel_ms), wall_ms.push_back(run.wall_ms);
    if (run.devices.size() < 2) continue;
    double sum_ms = 0;
    for (const DeviceShare& device : run.devices) sum_ms += device.kernel_ms;
    devices_ms.push_back(sum_ms);
  }
  summary.devices_ms = spread(std::move(devices_ms));
  summary.kernel_ms = spread(std::move(kernel_ms));
  summary.wall_ms = spread(std::move(wall_ms));
  summary.stages = summarize_stages(report.runs);
  if (!report.runs.empty()) {
    const RenderRun& last = report.runs.back();
    summary.waves = last.waves;
    summary.samples_done = last.samples_done;
    summary.ended_by = last.ended_by;
    summary.relative_error = last.relative_error;
    summary.metropolis = last.metropolis;
    for (const StageTime& time : last.stages) summary.launches += time.launches;
  }
  const PathCounts& counts = report.counts;
  summary.mpaths_per_s = millions_per_s(counts.paths, summary.kernel_ms.median);
  summary.mrays_per_s = millions_per_s(counts.rays + counts.shadow_rays, summary.kernel_ms.median);
  return summary;
}

std::uint64_t memory_bytes(const RenderReport& report) {
  std::uint64_t total = 0;
  for (const BufferSize& buffer : report.memory) total += buffer.size_bytes;
  return total;
}

std::vector<std::pair<std::string, double>> counter_fields(const KernelCounters& kernel,
                                                           int warps_per_sm) {
  const CounterRatios ratios = ratios_of(kernel.values, warps_per_sm);
  const auto get = [&](Counter counter) { return value_of(kernel.values, counter); };
  return {{"time_ms", 1e-6 * get(Counter::time_ns)},
          {"threads_per_instruction", ratios.threads_per_instruction},
          {"issue", ratios.issue},
          {"occupancy", ratios.occupancy},
          {"l1_hit_rate", ratios.l1_hit_rate},
          {"l2_hit_rate", ratios.l2_hit_rate},
          {"l2_bytes", get(Counter::l2_bytes)},
          {"l2_read_bytes", bytes_to_sm(kernel.values)},
          {"l2_written_bytes", bytes_from_sm(kernel.values)},
          {"dram_read_bytes", get(Counter::dram_read_bytes)},
          {"dram_written_bytes", get(Counter::dram_written_bytes)},
          {"predicted_read_bytes", kernel.predicted.read},
          {"predicted_written_bytes", kernel.predicted.written}};
}

}  // namespace pt
