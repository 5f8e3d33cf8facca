#include "app/report/counter_fields.h"

#include <fmt/format.h>

#include <cmath>

namespace pt {
namespace {

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

}  // namespace

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

}  // namespace pt
