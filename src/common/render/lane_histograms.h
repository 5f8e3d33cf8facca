// What lane counts come to: histograms, and how full warps were at each point.
#pragma once

#include <vector>

#include "common/options/stats.h"
#include "common/platform/lane_counter.h"

namespace pt {

/// Those that have counted anything, by point and bounce.
std::vector<LaneHistogram> lane_histograms(const LaneCounts& counts);

/// How full warps were at a point.
struct LaneUse {
  std::string point;
  std::uint64_t groups = 0;  ///< lanes of a warp that were there together
  std::uint64_t lanes = 0;   ///< in all of the groups

  double mean_lanes() const {  ///< of a group, 1 to 32
    return groups > 0 ? static_cast<double>(lanes) / static_cast<double>(groups) : 0.0;
  }
  double simt_efficiency() const { return mean_lanes() / 32; }  ///< above 0, 1 where all are full
};

/// For each point all of its histograms together: each group counts once, whatever its bounce. In
/// the order in which the points come first.
std::vector<LaneUse> lane_use(const std::vector<LaneHistogram>& histograms);

}  // namespace pt
