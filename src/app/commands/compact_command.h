// `ptexp compact`: the wavefront's compaction strategies by themselves, beside a copy.
#pragma once

#include "app/options/compact_options.h"

namespace pt {

/// Checks and measures each strategy in each case, and prints the times. Throws Error, also where
/// a strategy breaks its contract.
int compact_command(const CompactCommand& command);

}  // namespace pt
