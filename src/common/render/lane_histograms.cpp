#include "common/render/lane_histograms.h"

#include <algorithm>

namespace pt {

std::vector<LaneHistogram> lane_histograms(const LaneCounts& counts) {
  std::vector<LaneHistogram> histograms;
  for (int point = 0; point < lane_point_count; ++point) {
    for (int bounce = 0; bounce < lane_bounces; ++bounce) {
      LaneHistogram histogram{std::string(lane_points[point].name), bounce, {}};
      std::ranges::copy(counts.groups[point][bounce], histogram.groups.begin());
      const bool is_empty = std::ranges::all_of(histogram.groups, [](auto n) { return n == 0; });
      if (!is_empty) histograms.push_back(histogram);
    }
  }
  return histograms;
}

std::vector<LaneUse> lane_use(const std::vector<LaneHistogram>& histograms) {
  std::vector<LaneUse> uses;
  for (const LaneHistogram& histogram : histograms) {
    auto use = std::ranges::find(uses, histogram.point, &LaneUse::point);
    if (use == uses.end()) use = uses.insert(uses.end(), {histogram.point});
    for (std::uint64_t n = 1; n <= 32; ++n) {
      use->groups += histogram.groups[n - 1];
      use->lanes += n * histogram.groups[n - 1];
    }
  }
  return uses;
}

}  // namespace pt
