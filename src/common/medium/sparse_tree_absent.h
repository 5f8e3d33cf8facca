// As sparse_tree_nanovdb.h, without NanoVDB: no loader makes a sparse grid.
#pragma once

#include "common/medium/volume_grid.h"

namespace pt {

PT_HD void read_corners(const SparseBlock*, const std::int32_t (&)[2], const std::int32_t (&)[2],
                        const std::int32_t (&)[2], float (&values)[8]) {
  for (float& value : values) value = 0.0f;
}

}  // namespace pt
