// Which builder can build which tree where.
#pragma once

#include "common/options/options.h"

namespace pt {

/// Whether trees are built on the CUDA device.
inline bool is_device_builder(TreeBuilder builder) {
  return builder == TreeBuilder::lbvh || builder == TreeBuilder::hploc ||
         builder == TreeBuilder::hploc_reinsert;
}

/// Throws Error where a builder of the device is to work on the CPU, or for a structure that is not
/// a tree of ours. `accel` is the structure in use, never automatic.
void check_builder(TreeBuilder builder, AccelKind accel, bool on_cuda);

}  // namespace pt
