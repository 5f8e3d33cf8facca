// What lane counts come to, by hand.
#include <gtest/gtest.h>

#include <memory>
#include <set>

#include "common/render/lane_histograms.h"

namespace pt {
namespace {

LaneHistogram histogram(const char* point, int bounce,
                        const std::vector<std::pair<int, std::uint64_t>>& groups) {
  LaneHistogram result{point, bounce, {}};
  for (const auto& [lanes, count] : groups)
    result.groups[static_cast<std::size_t>(lanes) - 1] = count;
  return result;
}

TEST(LaneHistograms, ThoseThatCountedAnything) {
  const auto counts = std::make_unique<LaneCounts>();
  EXPECT_TRUE(lane_histograms(*counts).empty());
  counts->groups[static_cast<int>(LanePoint::bsdf)][2][31] = 7;
  counts->groups[static_cast<int>(LanePoint::node)][lane_bounces - 1][0] = 5;
  counts->groups[static_cast<int>(LanePoint::node)][0][3] = std::uint64_t{1} << 40;
  const std::vector<LaneHistogram> found = lane_histograms(*counts);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].point, "node");
  EXPECT_EQ(found[0].bounce, 0);
  EXPECT_EQ(found[0].groups, histogram("", 0, {{4, std::uint64_t{1} << 40}}).groups);
  EXPECT_EQ(found[1].point, "node");
  EXPECT_EQ(found[1].bounce, 63);
  EXPECT_EQ(found[1].groups, histogram("", 0, {{1, 5}}).groups);
  EXPECT_EQ(found[2].point, "bsdf");
  EXPECT_EQ(found[2].bounce, 2);
  EXPECT_EQ(found[2].groups, histogram("", 0, {{32, 7}}).groups);
}

TEST(LaneHistograms, EachGroupWeighsTheSameWhateverItsBounce) {
  const std::vector<LaneUse> uses =
      lane_use({histogram("node", 0, {{32, 1}}), histogram("bsdf", 0, {{32, 3}, {8, 1}, {1, 4}}),
                histogram("node", 1, {{4, 3}})});
  ASSERT_EQ(uses.size(), 2u);
  EXPECT_EQ(uses[0].point, "node");
  EXPECT_EQ(uses[0].groups, 4u);
  EXPECT_EQ(uses[0].lanes, 44u);  // 32 + 3 * 4
  EXPECT_DOUBLE_EQ(uses[0].mean_lanes(), 11.0);
  EXPECT_DOUBLE_EQ(uses[0].simt_efficiency(), 0.34375);
  EXPECT_EQ(uses[1].point, "bsdf");
  EXPECT_EQ(uses[1].groups, 8u);
  EXPECT_EQ(uses[1].lanes, 108u);  // 3 * 32 + 8 + 4
  EXPECT_DOUBLE_EQ(uses[1].mean_lanes(), 13.5);
}

TEST(LaneHistograms, FullWarpsAndSingleLanesAreTheEnds) {
  EXPECT_DOUBLE_EQ(lane_use({histogram("a", 0, {{32, 9}})})[0].simt_efficiency(), 1.0);
  EXPECT_DOUBLE_EQ(lane_use({histogram("a", 0, {{1, 9}})})[0].simt_efficiency(), 1.0 / 32);
  EXPECT_TRUE(lane_use({}).empty());
  EXPECT_EQ(LaneUse{}.mean_lanes(), 0.0);
}

TEST(LaneHistograms, PointsHaveNames) {
  std::set<std::string_view> names;
  for (const LanePointInfo& point : lane_points) {
    EXPECT_TRUE(names.insert(point.name).second) << point.name << " is there twice";
    EXPECT_FALSE(point.meaning.empty()) << point.name;
  }
}

}  // namespace
}  // namespace pt
