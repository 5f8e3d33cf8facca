// What `ptexp compact` is asked for.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/options/subcommand_option.h"
#include "wavefront/measure/measure_compaction.h"

namespace pt {

inline std::vector<Compaction> all_strategies() {
  std::vector<Compaction> strategies;
  for (const CompactionInfo& info : compaction_table) strategies.push_back(info.id);
  return strategies;
}

struct CompactCommand {
  std::vector<std::uint32_t> items{1u << 20, 1u << 22, 1u << 24};  ///< slots
  std::vector<float> densities{0.1f, 0.5f, 0.9f};                  ///< part of them that waits
  std::vector<int> queues{1, 2};                                   ///< that a pass fills
  std::vector<Compaction> strategies = all_strategies();
  std::uint32_t run_length = 1;
  DeviceChoice device;
  MeasuredRuns runs{3, 10, true};
  std::string csv;  ///< file to append a row to for each measurement; empty: none
  bool quiet = false;
  std::string command_line;  ///< for the record: the program's arguments
};

std::vector<SubcommandOption<CompactCommand>> compact_options();

}  // namespace pt
