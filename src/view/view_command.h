// `ptexp view SCENE`: the render in progress, as a page.
#pragma once

#include "app/options/command_line.h"

namespace pt {

/// Prints the page's address and serves it until a signal. Returns 130 or 143 (interrupt.h). Throws
/// Error.
int view_command(const ViewCommand& command);

}  // namespace pt
