// What `ptexp trace` and `ptexp rays` are asked for.
#pragma once

#include <string>
#include <vector>

#include "app/options/subcommand_option.h"
#include "common/options/options.h"
#include "common/rays/generate_rays.h"
#include "common/rays/trace_rays.h"

namespace pt {

struct TraceCommand {
  std::string mesh, rays;  ///< files
  std::string hits;        ///< reference to compare with; empty: none
  std::string output;      ///< file for the hits; empty: none
  std::string csv;         ///< file to append a row to; empty: none
  AccelKind accel = AccelKind::automatic;
  TreeBuilder builder = TreeBuilder::automatic;
  DeviceChoice device;
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
  CameraOverrides camera;  ///< else the scene's, or inside a mesh's bounding box, looking along it
};

std::vector<SubcommandOption<TraceCommand>> trace_options();
std::vector<SubcommandOption<RaysCommand>> rays_options();

}  // namespace pt
