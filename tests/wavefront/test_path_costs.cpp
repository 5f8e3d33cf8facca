// How many of the last paths are finished alone, by what a path costs.
#include <gtest/gtest.h>

#include "common/scene/prepare_materials.h"
#include "mode_cases.h"
#include "wavefront/path_costs.h"

namespace pt {
namespace {

std::uint32_t finish_paths(const std::string& scene, const Settings& settings = {}) {
  const Options options = with(with(Options(), {{"device", "cpu"}, {"scene", scene}}), settings);
  return finish_paths_of(options, make_scene_for(options, choose_device(options.device)));
}

TEST(FinishPaths, AreFewWherePathsAreDear) {
  EXPECT_EQ(finish_paths("spheres"), 131072u);
  EXPECT_EQ(finish_paths("rtow"), 131072u);
  EXPECT_EQ(finish_paths("cornell"), 131072u);
  EXPECT_EQ(finish_paths("statue:1K"), 32768u);
  EXPECT_EQ(finish_paths("instances:10"), 8192u);
  EXPECT_EQ(finish_paths("dial:16:0:closed"), 8192u);
}

TEST(FinishPaths, AreWhatIsAskedFor) {
  EXPECT_EQ(finish_paths("spheres", {{"finish-paths", "auto"}}), 131072u);
  EXPECT_EQ(finish_paths("spheres", {{"finish-paths", "0"}}), 0u);
  EXPECT_EQ(finish_paths("dial:16:0:closed", {{"finish-paths", "1000"}}), 1000u);
}

TEST(OrderOfSurfaces, PaysForManyKindsOrALongOne) {
  const auto bit = [](MaterialKind kind) { return 1u << static_cast<int>(kind); };
  const std::uint32_t five = bit(kind_of<Diffuse>) | bit(kind_of<Plastic>) | bit(kind_of<Phong>) |
                             bit(kind_of<Ward>) | bit(kind_of<Conductor>);
  EXPECT_FALSE(order_pays_for(bit(kind_of<Principled>)));
  EXPECT_TRUE(order_pays_for(bit(kind_of<Principled>) | bit(kind_of<Diffuse>)));
  EXPECT_FALSE(order_pays_for(five));
  EXPECT_TRUE(order_pays_for(five | bit(kind_of<Metal>)));
}

}  // namespace
}  // namespace pt
