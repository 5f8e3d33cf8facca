// What a finished tree over triangles is like, whoever built it and wherever it lies.
#pragma once

#include <string>

#include "common/accel/build/tree_statistics.h"
#include "common/accel/build/triangle_tree_data.h"

namespace pt {

struct TreeSummary {
  std::string builder;           ///< by name; empty: there is no tree
  TreeQuality quality;           ///< of both levels where there are instances
  std::uint64_t size_bytes = 0;  ///< of nodes, triangles and instances
  double build_ms = 0;           ///< on the CPU wall time; on CUDA of kernels, and the CPU's share
};

TreeSummary summarize(const TriangleTreeData& tree);

}  // namespace pt
