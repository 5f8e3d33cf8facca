// `ptexp [options]`: renders, writes the image and reports.
#pragma once

#include "app/options/command_line.h"

namespace pt {

/// Returns the exit code: 0, or 130 after SIGINT, the image then holding the samples that were
/// finished. Throws Error; outputs that cannot be written are refused before any work.
int render_command(const RenderCommand& command);

}  // namespace pt
