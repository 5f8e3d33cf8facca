#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/options/option_values.h"
#include "app/report/report.h"
#include "common/options/option_names.h"
#include "common/render/lane_histograms.h"

namespace pt {
namespace {

std::string time_columns(const Spread& time, bool repeated) {
  const std::string median = fmt::format("{:>12.3f}", time.median);
  return repeated ? median + fmt::format("{:>12.3f}{:>12.3f}", time.min, time.max) : median;
}

std::string stage_rows(const RenderReport& report, const RunSummary& summary) {
  const bool repeated = report.runs.size() > 1;
  std::string text = fmt::format(
      "{:<16}{:>12}{}{:>9}{:>11}\n", "stage", repeated ? "median ms" : "ms",
      repeated ? fmt::format("{:>12}{:>12}", "min ms", "max ms") : "", "share", "launches");
  // The times of stages are sums over all devices, the kernel time is the longest one's.
  const bool has_several = summary.devices_ms.median > 0;
  const double total = (has_several ? summary.devices_ms : summary.kernel_ms).median;
  for (const StageSummary& stage : summary.stages)
    text += fmt::format(
        "{:<16}{}{:>7.1f} %{:>11}\n", stage.stage, time_columns(stage.time_ms, repeated),
        total > 0 ? 100 * stage.time_ms.median / total : 0, grouped(stage.launches));
  if (has_several)
    text += fmt::format("{:<16}{}\n", "all devices", time_columns(summary.devices_ms, repeated));
  return text + fmt::format("{:<16}{}{:>9}{:>11}\n", "kernel time",
                            time_columns(summary.kernel_ms, repeated), "",
                            grouped(summary.launches));
}

/// A row for each of several devices.
std::string device_rows(const RenderReport& report) {
  if (report.runs.empty() || report.runs.back().devices.size() < 2) return "";
  std::string text = fmt::format("{:<16}{:>12}{:>12}{:>9}{:>18}\n", "device", "kernel ms",
                                 "wall ms", "units", "samples");
  for (const DeviceShare& device : report.runs.back().devices)
    text += fmt::format("{:<16}{:>12.3f}{:>12.3f}{:>9}{:>18}\n", device.name, device.kernel_ms,
                        device.wall_ms, grouped(device.units), grouped(device.samples));
  return text + '\n';
}

std::string count_rows(const PathCounts& counts, const RunSummary& summary) {
  std::string text = fmt::format("{:<16}{:>18}{:>12.2f} Mpaths/s\n{:<16}{:>18}{:>12.2f} Mrays/s\n",
                                 "paths", grouped(counts.paths), summary.mpaths_per_s, "rays",
                                 grouped(counts.rays + counts.shadow_rays), summary.mrays_per_s);
  if (counts.shadow_rays > 0)
    text += fmt::format("{:<16}{:>18}\n", "  of them shadow", grouped(counts.shadow_rays));
  if (summary.waves > 0) text += fmt::format("{:<16}{:>18}\n", "waves", grouped(summary.waves));
  if (counts.nonfinite_samples > 0)
    text += fmt::format("{:<16}{:>18}  left out of the image\n", "NaN, Inf samples",
                        grouped(counts.nonfinite_samples));
  return text;
}

std::string divergence_rows(const RenderReport& report) {
  if (report.divergence.empty()) return "";
  std::string text = "\nThis build counts lanes: its times tell nothing.\n" +
                     fmt::format("{:<16}{:>18}{:>18}{:>18}\n", "point", "lanes of 32",
                                 "SIMT efficiency", "groups of lanes");
  for (const LaneUse& use : lane_use(report.divergence))
    text += fmt::format("{:<16}{:>18.2f}{:>16.1f} %{:>18}\n", use.point, use.mean_lanes(),
                        100 * use.simt_efficiency(), grouped(use.groups));
  return text;
}

std::string metropolis_rows(const std::optional<MetropolisStats>& stats) {
  if (!stats) return "";
  const auto percent = [](const char* name, double share) {
    return fmt::format("{:<16}{:>16.2f} %\n", name, 100 * share);
  };
  return fmt::format("{:<16}{:>18}{:>12.2f} Mmutations/s\n", "mutations", grouped(stats->mutations),
                     1e-6 * stats->mutations_per_s) +
         fmt::format("{:<16}{:>18}  after {} bootstrap paths ({:.1f} ms)\n", "chains",
                     grouped(stats->chains), grouped(stats->bootstrap), stats->bootstrap_ms) +
         fmt::format("{:<16}{:>18.6g}  +- {:.2g} mean luminance\n", "brightness b",
                     stats->brightness, stats->brightness_error) +
         percent("large steps", stats->large_share) +
         percent("  accepted", stats->large_acceptance) +
         percent("small accepted", stats->small_acceptance);
}

std::string stop_row(const Options& options, const RunSummary& summary) {
  std::string text;
  if (summary.ended_by != RunEnd::samples) {
    text += fmt::format("{:<16}{:>18}\n", "ended by", to_string(summary.ended_by));
  }
  if (summary.relative_error) {
    text += fmt::format("{:<16}{:>18.6f}  of the image's mean luminance\n", "standard error",
                        *summary.relative_error);
    const double factor =
        options.target_error > 0 ? *summary.relative_error / options.target_error : 0;
    if (factor > 1 && std::isfinite(factor))
      text += fmt::format("{:<16}{:>18}  would take about {:.3g} times the samples\n",
                          "--target-error", number_text(options.target_error), factor * factor);
  }
  return text;
}

std::string percent(double ratio) {
  return std::isnan(ratio) ? fmt::format("{:>8}", "-") : fmt::format("{:>8.1f}", 100 * ratio);
}

std::string megabytes(double bytes) { return fmt::format("{:>10.2f}", 1e-6 * bytes); }

std::string kernel_row(const KernelCounters& kernel, int warps_per_sm) {
  const CounterRatios ratios = ratios_of(kernel.values, warps_per_sm);
  const auto get = [&](Counter counter) { return value_of(kernel.values, counter); };
  const bool predicted = kernel.predicted.read + kernel.predicted.written > 0;
  return fmt::format("{:<24}{:>9}{:>10.3f}{:>9.1f}{}{}{}{}{}{}{}{}{}\n", kernel.kernel,
                     kernel.launches, 1e-6 * get(Counter::time_ns), ratios.threads_per_instruction,
                     percent(ratios.issue), percent(ratios.occupancy), percent(ratios.l1_hit_rate),
                     percent(ratios.l2_hit_rate), megabytes(bytes_to_sm(kernel.values)),
                     megabytes(bytes_from_sm(kernel.values)),
                     predicted ? megabytes(kernel.predicted.read) : fmt::format("{:>10}", "-"),
                     predicted ? megabytes(kernel.predicted.written) : fmt::format("{:>10}", "-"),
                     megabytes(get(Counter::dram_read_bytes) + get(Counter::dram_written_bytes)));
}

/// The counters of each kernel that takes time worth mentioning.
std::string counter_rows(const HardwareCounters& counters) {
  if (!counters.problem.empty()) return "";  // a warning has told
  constexpr double least_share = 0.001;
  const KernelCounters all = sum_all(counters.launches);
  const double least_ns = least_share * value_of(all.values, Counter::time_ns);
  std::string text = fmt::format(
      "hardware counters of one batch, {} samples per pixel; megabytes between multiprocessors and "
      "L2,\nthe same as the layout of the paths predicts them, and of DRAM\n"
      "{:<24}{:>9}{:>10}{:>9}{:>8}{:>8}{:>8}{:>8}{:>10}{:>10}{:>10}{:>10}{:>10}\n",
      counters.samples, "kernel", "launches", "ms", "threads", "issue %", "occup.%", "L1 hit%",
      "L2 hit%", "read", "written", "predicted", "written", "DRAM");
  for (const KernelCounters& kernel : sum_by_kernel(counters.launches)) {
    if (value_of(kernel.values, Counter::time_ns) >= least_ns) {
      text += kernel_row(kernel, counters.warps_per_sm);
    }
  }
  KernelCounters sum = all;
  sum.kernel = "all kernels";
  text += kernel_row(sum, counters.warps_per_sm);
  const double rays = static_cast<double>(counters.rays);
  if (rays > 0) {
    text += fmt::format(
        "bytes per ray: {:.0f} between multiprocessors and L2, {:.0f} predicted, {:.0f} DRAM\n",
        (bytes_to_sm(all.values) + bytes_from_sm(all.values)) / rays,
        (all.predicted.read + all.predicted.written) / rays,
        (value_of(all.values, Counter::dram_read_bytes) +
         value_of(all.values, Counter::dram_written_bytes)) /
            rays);
  }
  if (counters.uncounted_launches > 0) {
    text += fmt::format("the last {} launches were not counted\n", counters.uncounted_launches);
  }
  return text;
}

std::string process_row(const ProcessTimes& t) {
  if (t.total() == 0) return "";
  return fmt::format(
      "process {:.0f} ms: start {:.0f}, devices {:.0f}, scene {:.0f}, preparing {:.0f}, set-up "
      "{:.0f}, rendering {:.0f}, image {:.0f}\n",
      t.total(), t.start, t.devices, t.scene, t.prepare, t.setup, t.render, t.image);
}

}  // namespace

bool is_complete(const Options& options, const RenderReport& report) {
  return static_cast<int>(report.runs.size()) == options.repeat &&
         std::ranges::all_of(report.runs,
                             [&](const RenderRun& run) { return !is_cut_short(run, options.spp); });
}

std::string report_table(const Options& options, const RenderReport& report) {
  const RunSummary summary = summarize(report);
  return fmt::format(
             "{} of '{}', {}x{}, {} samples per pixel, on {}{}\n\n", report.mode, options.scene,
             options.width, options.height, summary.samples_done, report.device_name,
             report.runs.size() > 1 ? fmt::format(", {} repeats", report.runs.size()) : "") +
         stage_rows(report, summary) + '\n' + device_rows(report) +
         count_rows(report.counts, summary) + metropolis_rows(summary.metropolis) +
         stop_row(options, summary) +
         fmt::format(
             "\nnot in the kernel time: scene {:.1f} ms, set-up {:.1f} ms, {}"
             "transfer {:.1f} ms, writing the image {:.1f} ms\n",
             report.scene_ms, report.setup_ms,
             report.load_ms > 0 ? fmt::format("loading kernels {:.1f} ms, ", report.load_ms) : "",
             report.transfer_ms, report.image_write_ms) +
         process_row(report.process_ms) +
         (report.counters ? '\n' + counter_rows(*report.counters) : "") + divergence_rows(report);
}

}  // namespace pt
