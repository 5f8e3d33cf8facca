// `ptexp verify IMAGE`: whether an image is what its header says.
#pragma once

#include "app/options/command_line.h"

namespace pt {

/// Renders random pixels again and compares their bits. Returns 0, or 1 where any differ. Throws
/// Error where they cannot be rendered here: another scene, no such device, no header.
int verify_command(const VerifyCommand& command);

}  // namespace pt
