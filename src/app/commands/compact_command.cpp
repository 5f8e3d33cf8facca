#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "app/commands/commands.h"
#include "app/options/option_values.h"
#include "app/render/render_outputs.h"
#include "app/report/csv_file.h"
#include "app/report/report.h"
#include "common/device/devices.h"
#include "common/error/error.h"
#include "common/error/terminal.h"

namespace pt {
namespace {

/// Median times of copies of the same size; 0 for a way that the device lacks.
struct CopyTimes {
  double memcpy_ms = 0, kernel_ms = 0;

  double best_ms() const { return kernel_ms > 0 ? std::min(memcpy_ms, kernel_ms) : memcpy_ms; }
};

struct CompactMeasurement {
  CompactionCase slots;
  Compaction strategy = Compaction::cub;
  std::uint64_t waiting = 0, bytes = 0;
  PassPlan plan;
  Spread time_ms;
  CopyTimes copy;

  double gb_per_s(double ms) const { return ms > 0 ? static_cast<double>(bytes) / ms / 1e6 : 0; }
  double copy_share() const { return time_ms.median > 0 ? copy.best_ms() / time_ms.median : 0; }
};

class CompactRun {
 public:
  CompactRun(const CompactCommand& command, const DeviceInfo& info, CompactionDevice& device)
      : command_(command), info_(info), device_(device) {}

  CompactMeasurement measure(const CompactionCase& slots, const std::vector<StageId>& tags,
                             Compaction strategy) {
    const std::string breach =
        contract_breach(strategy, tags, device_.compact(strategy, tags, slots.queues));
    if (!breach.empty()) {
      throw Error(
          fmt::format("compaction {} of {} slots: {}", to_string(strategy), slots.items, breach));
    }
    CompactMeasurement m;
    m.slots = slots;
    m.strategy = strategy;
    m.waiting = count_waiting(tags);
    m.bytes = moved_bytes(strategy, slots.items, m.waiting);
    m.plan = device_.plan(slots.items, m.bytes, command_.runs.cold);
    m.time_ms =
        spread(device_.time_compaction(strategy, tags, slots.queues, m.plan, command_.runs));
    m.copy = copy_of(m.bytes, m.plan);
    return m;
  }

  CsvRow csv_row(const CompactMeasurement& m) const {
    const auto number = [](double x) { return fmt::format("{:.6g}", x); };
    const auto rate = [&](double ms) { return ms > 0 ? number(m.gb_per_s(ms)) : ""; };
    CsvRow row = origin_columns(command_.command_line, info_, device_.threads());
    const CsvRow own{{"strategy", to_string(m.strategy)},
                     {"queues", std::to_string(m.slots.queues)},
                     {"items", std::to_string(m.slots.items)},
                     {"density", number(static_cast<double>(m.slots.density))},
                     {"run", std::to_string(m.slots.run_length)},
                     {"waiting", std::to_string(m.waiting)},
                     {"cache", command_.runs.cold ? "cold" : "warm"},
                     {"repeat", std::to_string(command_.runs.repeat)},
                     {"warmup", std::to_string(command_.runs.warmup)},
                     {"passes", std::to_string(m.plan.passes)},
                     {"sets", std::to_string(m.plan.sets)},
                     {"time_ms", number(m.time_ms.median)},
                     {"time_min_ms", number(m.time_ms.min)},
                     {"time_max_ms", number(m.time_ms.max)},
                     {"bytes", std::to_string(m.bytes)},
                     {"gb_per_s", number(m.gb_per_s(m.time_ms.median))},
                     {"memcpy_gb_per_s", rate(m.copy.memcpy_ms)},
                     {"kernel_gb_per_s", rate(m.copy.kernel_ms)},
                     {"copy_gb_per_s", rate(m.copy.best_ms())},
                     {"copy_share", number(m.copy_share())}};
    row.insert(row.end(), own.begin(), own.end());
    return row;
  }

 private:
  /// Strategies that move the same bytes share the copy.
  CopyTimes copy_of(std::uint64_t bytes, const PassPlan& plan) {
    const auto [found, is_new] = copies_.try_emplace({bytes, plan.passes, plan.sets});
    if (!is_new) return found->second;
    for (const CopyWay way : device_.copy_ways()) {
      const double ms = spread(device_.time_copy(way, bytes, plan, command_.runs)).median;
      (way == CopyWay::memcpy ? found->second.memcpy_ms : found->second.kernel_ms) = ms;
    }
    return found->second;
  }

  const CompactCommand& command_;
  const DeviceInfo& info_;
  CompactionDevice& device_;
  std::map<std::tuple<std::uint64_t, std::uint32_t, std::uint32_t>, CopyTimes> copies_;
};

std::unique_ptr<CompactionDevice> make_device([[maybe_unused]] const DeviceInfo& info) {
#ifdef PTEXP_CUDA
  if (info.choice.kind == DeviceChoice::Kind::cuda)
    return make_compaction_cuda(info.choice.index, info.sms);
#endif
  return make_compaction_cpu();
}

void print_heading(const DeviceInfo& info) {
  print("device     {}: {}\n", to_string(info.choice), info.name);
  print("{:8} {:>6} {:>13} {:>8} {:>12} {:>25} {:>8} {:>8} {:>6}\n", "strategy", "queues", "items",
        "density", "us a pass", "from ... to", "GB/s", "copy", "share");
}

void print_row(const CompactMeasurement& m) {
  const Spread& t = m.time_ms;
  print("{:8} {:>6} {:>13} {:>8.4g} {:>12.2f} {:>12.2f}{:>13.2f} {:>8.1f} {:>8.1f} {:>6.3f}\n",
        to_string(m.strategy), m.slots.queues, grouped(m.slots.items), m.slots.density,
        1e3 * t.median, 1e3 * t.min, 1e3 * t.max, m.gb_per_s(t.median),
        m.gb_per_s(m.copy.best_ms()), m.copy_share());
}

}  // namespace

int compact_command(const CompactCommand& command) {
  const DeviceInfo info = limited(choose_device(command.device), command.limits);
  const auto device = make_device(info);
  CompactRun run(command, info, *device);
  Attempts attempts;
  bool has_csv = !command.csv.empty();
  if (!command.csv.empty()) check_csv(command.csv, run.csv_row({}));
  if (!command.quiet) print_heading(info);
  for (const int queues : command.queues) {
    for (const std::uint32_t items : command.items) {
      for (const float density : command.densities) {
        const CompactionCase slots{items, density, command.run_length, queues};
        const std::vector<StageId> tags = make_tags(slots);
        for (const Compaction strategy : command.strategies) {
          const CompactMeasurement m = run.measure(slots, tags, strategy);
          if (!command.quiet) print_row(m);
          if (has_csv)
            has_csv = attempts.make([&] { append_csv_row(command.csv, run.csv_row(m)); });
        }
      }
    }
  }
  attempts.check();
  return 0;
}

}  // namespace pt
