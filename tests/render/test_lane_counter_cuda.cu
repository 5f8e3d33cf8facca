// Lanes that are at a point together, known beforehand: in a kernel that says which are.
#include "common/platform/lane_counter.h"
#include "cuda_test.h"

namespace pt {
namespace {

using Counter = LaneCounterIf<true>;  // in every build

/// A warp: lanes below `few` count at a node, the others at another one; then all at a third, where
/// the lanes' rays have bounces `first`, `first` + 1, ...; then the odd ones for shadow rays.
__global__ void count_lanes(Counter counter, int few, std::uint32_t first) {
  const auto lane = threadIdx.x & 31u;
  if (static_cast<int>(lane) < few) {
    counter.at(0).count(LanePoint::node);
  } else {
    counter.at(1).count(LanePoint::node);
  }
  __syncwarp();
  counter.at(first + lane).count(LanePoint::bsdf);
  __syncwarp();
  const Counter shadow = counter.at(5).of_shadow_ray();
  if (lane % 2 == 1) {
    shadow.count(LanePoint::intersect);
    shadow.count(LanePoint::node);
    shadow.count(LanePoint::primitive);
    shadow.count(LanePoint::light);
  }
}

class CudaLaneCounter : public CudaTest {
 protected:
  /// The counts after `warps` warps of the kernel.
  static LaneCounts run(int warps, int few, std::uint32_t first) {
    const DeviceArray<LaneCounts> counts(std::vector<LaneCounts>(1));
    count_lanes<<<warps, 32>>>(Counter(counts.data()), few, first);
    return counts.download()[0];
  }
  static std::uint64_t of(const LaneCounts& counts, LanePoint point, int bounce, int lanes) {
    return counts.groups[static_cast<int>(point)][bounce][lanes - 1];
  }
  static std::uint64_t sum(const LaneCounts& counts) {
    std::uint64_t result = 0;
    for (const auto& point : counts.groups)
      for (const auto& bounce : point)
        for (const std::uint64_t groups : bounce) result += groups;
    return result;
  }
};

TEST_F(CudaLaneCounter, GroupsOfLanesCountOnce) {
  for (const int few : {1, 5, 16, 31}) {
    const LaneCounts counts = run(100, few, 7);
    EXPECT_EQ(of(counts, LanePoint::node, 0, few), 100u);
    EXPECT_EQ(of(counts, LanePoint::node, 1, 32 - few), 100u);
    EXPECT_EQ(of(counts, LanePoint::bsdf, 7, 32), 100u) << "the bounce of the first lane";
    EXPECT_EQ(of(counts, LanePoint::shadow, 5, 16), 100u);
    EXPECT_EQ(of(counts, LanePoint::shadow_node, 5, 16), 100u);
    EXPECT_EQ(of(counts, LanePoint::shadow_primitive, 5, 16), 100u);
    EXPECT_EQ(of(counts, LanePoint::light, 5, 16), 100u);
    EXPECT_EQ(sum(counts), 700u);
  }
}

TEST_F(CudaLaneCounter, TheLastBounceStandsForAllFromThereOn) {
  for (const std::uint32_t first : {63u, 64u, 65535u, 0xffffffe0u}) {
    EXPECT_EQ(of(run(3, 8, first), LanePoint::bsdf, 63, 32), 3u) << first;
  }
  EXPECT_EQ(of(run(3, 8, 62), LanePoint::bsdf, 62, 32), 3u);
}

TEST_F(CudaLaneCounter, CountsBeyond32Bits) {
  std::vector<LaneCounts> full(1);
  full[0].groups[static_cast<int>(LanePoint::bsdf)][0][31] = 0xffffffffu;
  const DeviceArray<LaneCounts> counts(full);
  count_lanes<<<2, 32>>>(Counter(counts.data()), 4, 0);
  EXPECT_EQ(of(counts.download()[0], LanePoint::bsdf, 0, 32), std::uint64_t{0x100000001});
}

TEST_F(CudaLaneCounter, ACounterOfNothingCountsNothing) {
  count_lanes<<<1, 32>>>(Counter(), 4, 0);
  EXPECT_EQ(cudaDeviceSynchronize(), cudaSuccess);
}

}  // namespace
}  // namespace pt
