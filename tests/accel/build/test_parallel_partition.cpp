// Partitioning in parallel puts what it should to the left, and loses nothing.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>

#include "common/accel/build/binary/parallel.h"
#include "statistics.h"

namespace pt {
namespace {

TEST(ParallelPartition, PutsTheLeftOnesFirst) {
  TestRandom random;
  for (const std::size_t size : {0u, 1u, 100u, 16384u, 16385u, 200'000u}) {
    for (const double part : {0.0, 0.001, 0.3, 0.5, 0.98, 1.0}) {
      std::vector<std::uint32_t> values(size);
      for (std::uint32_t& v : values) v = random.bits();
      if (part == 0.5) std::sort(values.begin(), values.end(), std::greater<>());
      const auto goes_left = [&](std::uint32_t v) { return v < part * 0x1p32; };
      std::vector<std::uint32_t> parted = values, again = values;
      const std::size_t left = parallel_partition(std::span(parted), goes_left);
      EXPECT_EQ(left,
                static_cast<std::size_t>(std::count_if(values.begin(), values.end(), goes_left)));
      EXPECT_TRUE(std::is_partitioned(parted.begin(), parted.end(), goes_left));
      {
        tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
        parallel_partition(std::span(again), goes_left);
      }
      EXPECT_TRUE(parted == again) << "depends on the number of threads";
      std::sort(values.begin(), values.end()), std::sort(parted.begin(), parted.end());
      EXPECT_TRUE(values == parted);
    }
  }
}

}  // namespace
}  // namespace pt
