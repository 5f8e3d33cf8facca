// The same settings as renders in several modes.
#pragma once

#include <vector>

#include "app/options/command_line.h"

namespace pt {

/// The render of these settings in `mode`, seen by the scene's own camera. What has no effect in
/// that mode is left out. Throws Error for settings that go together in no mode.
RenderCommand mode_command(const std::vector<Setting>& settings, Mode mode);

}  // namespace pt
