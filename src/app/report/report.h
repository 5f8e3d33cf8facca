// What a finished run tells: a table for people, JSON and CSV for programs (docs/statistics.md);
// and the numbers that they share, of the repeats of a measurement and of the hardware counters.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/options/hardware_counters.h"
#include "common/options/options.h"
#include "common/options/stats.h"

namespace pt {

struct Spread {
  double median = 0;  ///< the mean of the two middle values where their number is even
  double min = 0;
  double max = 0;
};

/// All zero for no values.
Spread spread(std::vector<double> values);

/// The 95 % percentile interval, by bootstrap (Efron 1979), of a statistic of `count` measured
/// things, at least one: `statistic` is called with the indices of each resample. The same
/// statistic has the same interval each time.
std::pair<double, double> bootstrap_interval(
    std::size_t count, std::size_t resamples,
    const std::function<double(std::span<const std::size_t>)>& statistic);

struct StageSummary {
  std::string stage;
  Spread time_ms;              ///< over the repeats
  std::uint64_t launches = 0;  ///< of the last repeat
};

struct RunSummary {
  Spread kernel_ms, wall_ms;         ///< over the repeats
  Spread devices_ms;                 ///< the kernel times of several devices in all; of one: 0
  std::vector<StageSummary> stages;  ///< in the order in which the runs first name them
  std::uint64_t waves = 0;           ///< of the last repeat, as is what follows
  std::uint64_t launches = 0;        ///< of all stages
  int samples_done = 0;              ///< per pixel
  RunEnd ended_by = RunEnd::samples;
  std::optional<double> relative_error;
  std::optional<MetropolisStats> metropolis;
  double mpaths_per_s = 0;  ///< 10^6 paths / median kernel time; 0 where that is 0
  double mrays_per_s = 0;   ///< 10^6 rays of all kinds / median kernel time
};

RunSummary summarize(const RenderReport& report);

std::uint64_t memory_bytes(const RenderReport& report);  ///< the sum of all buffers

/// Name and value of each hardware counter of some launches; NaN where there was nothing to divide
/// by.
std::vector<std::pair<std::string, double>> counter_fields(const KernelCounters& kernel,
                                                           int warps_per_sm);

/// The parts of ProcessTimes by name, in their order.
inline constexpr std::pair<const char*, double ProcessTimes::*> process_parts[] = {
    {"start", &ProcessTimes::start}, {"devices", &ProcessTimes::devices},
    {"scene", &ProcessTimes::scene}, {"prepare", &ProcessTimes::prepare},
    {"setup", &ProcessTimes::setup}, {"render", &ProcessTimes::render},
    {"image", &ProcessTimes::image}};

/// Version of the JSON and the CSV. Raise it, and change docs/statistics.md, whenever a field is
/// added or removed or changes its name, unit or meaning.
inline constexpr int report_schema_version = 15;

/// Every repeat ran, and the last one had all its samples.
bool is_complete(const Options& options, const RenderReport& report);

/// A short table of times, counts and rates; ends with a newline.
std::string report_table(const Options& options, const RenderReport& report);

/// All of `options` and `report`, and what the program was built from.
std::string report_json(const Options& options, const RenderReport& report);

/// Column name and value of one CSV row; the names are the same for every run.
using CsvRow = std::vector<std::pair<std::string, std::string>>;
CsvRow report_csv_row(const Options& options, const RenderReport& report);

}  // namespace pt
