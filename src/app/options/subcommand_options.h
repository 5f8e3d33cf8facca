// The subcommands `trace`, `rays`, `compact`, `doctor`, `measure` and `calibrate`, and the tables
// of their options.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/options/option_list.h"
#include "common/options/options.h"
#include "common/rays/generate_rays.h"
#include "common/rays/trace_rays.h"
#include "wavefront/measure/measure_compaction.h"

namespace pt {

/// `set` parses and stores; it throws Error naming option and value.
template <class Command>
struct SubcommandOption {
  const char* name;
  const char* placeholder;  ///< "N [1]": what the help shows for value and default; null: a flag
  const char* help;
  void (*set)(Command&, const std::string& value);
  bool is_required = false;
};

struct TraceCommand {
  std::string mesh, rays;  ///< files
  std::string hits;        ///< reference to compare with; empty: none
  std::string output;      ///< file for the hits; empty: none
  std::string csv;         ///< file to append a row to; empty: none
  AccelKind accel = AccelKind::automatic;
  TreeBuilder builder = TreeBuilder::automatic;
  DeviceChoice device;
  DeviceLimits limits;
  TraceRuns runs;
  bool quiet = false;
  std::string command_line;  ///< for the record: the program's arguments
};

struct RaysCommand {
  std::string scene;  ///< as load_traced_scene takes it
  std::string output;
  RayKind kind = RayKind::primary;
  int bounces = 0;  ///< RayKind::bounce
  int size = 2048;
  CameraOverrides camera;  ///< default: the scene's; for a mesh, inside its bounding box
};

inline std::vector<Compaction> all_strategies() {
  std::vector<Compaction> strategies;
  for (const CompactionInfo& info : compaction_table) strategies.push_back(info.id);
  return strategies;
}

struct CompactCommand {
  std::vector<std::uint32_t> items{1u << 20, 1u << 22, 1u << 24};  ///< slots
  std::vector<float> densities{0.1f, 0.5f, 0.9f};                  ///< fraction that waits
  std::vector<int> queues{1, 2};                                   ///< filled by a pass
  std::vector<Compaction> strategies = all_strategies();
  std::uint32_t run_length = 1;
  DeviceChoice device;
  DeviceLimits limits;
  MeasuredRuns runs{3, 10, true};
  std::string csv;  ///< file to append a row to for each measurement; empty: none
  bool quiet = false;
  std::string command_line;  ///< for the record: the program's arguments
};

struct DoctorCommand {
  bool as_json = false;
};

/// Its configurations come from the standard input.
struct MeasureCommand {};

/// Measures the plan's constants.
struct CalibrateCommand {
  std::vector<Setting> settings;  ///< the device and its threads
  bool is_quiet = false;
};

std::vector<SubcommandOption<TraceCommand>> trace_options();
std::vector<SubcommandOption<RaysCommand>> rays_options();
std::vector<SubcommandOption<CompactCommand>> compact_options();
std::vector<SubcommandOption<DoctorCommand>> doctor_options();
std::vector<SubcommandOption<CalibrateCommand>> calibrate_options();

}  // namespace pt
