// `ptexp trace`: a file of rays against a mesh; `ptexp rays`: makes such files.
#pragma once

#include "app/options/trace_options.h"

namespace pt {

/// Prints rate, tree and agreement. Returns the exit code: 1 where hits differ from the reference.
/// Throws Error.
int trace_command(const TraceCommand& command);

/// Throws Error.
int rays_command(const RaysCommand& command);

}  // namespace pt
