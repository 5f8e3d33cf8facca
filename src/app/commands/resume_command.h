// `ptexp resume FILE`: goes on with the render of a checkpoint.
#pragma once

#include <vector>

#include "app/commands/render_command.h"
#include "app/options/command_line.h"
#include "common/device/devices.h"

namespace pt {

/// As render_command. The checkpoint goes on in the same file unless --checkpoint names another.
int resume_command(const ResumeCommand& command, Ranks& ranks);

/// Throws Error where the scene or the devices give other samples than the checkpoint has.
void check_resumption(const Resumption& resumption, const Options& options,
                      const std::string& scene_hash, const std::vector<DeviceInfo>& devices);

}  // namespace pt
