// What a finished run tells: a table for people, JSON and CSV for programs (docs/statistics.md).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/options/options.h"
#include "common/options/stats.h"

namespace pt {

/// Version of the JSON and the CSV. Raise it, and change docs/statistics.md, whenever a field is
/// added or removed or changes its name, unit or meaning.
inline constexpr int report_schema_version = 13;

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
