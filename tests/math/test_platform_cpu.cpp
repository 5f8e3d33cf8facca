// The functions that take the place of the C library's: the same bits.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "common/platform/platform.h"
#include "common/sampling/random.h"

namespace pt {
namespace {

std::vector<float> nasty_numbers() {
  const float infinity = std::numeric_limits<float>::infinity();
  std::vector<float> result = {0.0f,
                               0x1p-149f,
                               0x1p-126f,
                               0.5f,
                               1.0f,
                               1.5f,
                               8388607.0f,
                               8388607.5f,
                               8388608.0f,
                               2147483648.0f,
                               1e30f,
                               infinity,
                               std::numeric_limits<float>::quiet_NaN()};
  for (std::uint32_t i = 0; i < 500; ++i) {
    const Uint4 bits = philox4x32_10({i, 0, 0, 0}, 1, 2);
    const float any = bits_to_float(bits.x);
    if (!std::isnan(any)) result.push_back(any);  // no arithmetic gives a signaling one
    result.push_back(1000.0f * static_cast<float>(bits.y) * 0x1p-32f);
    result.push_back(std::floor(result.back()));
  }
  const std::size_t count = result.size();
  for (std::size_t i = 0; i < count; ++i) result.push_back(-result[i]);
  return result;
}

void expect_same(float value, float expected, float a, float b) {
  if (std::isnan(expected)) {
    EXPECT_TRUE(std::isnan(value)) << a << ", " << b;
  } else {
    EXPECT_EQ(float_to_bits(value), float_to_bits(expected)) << a << ", " << b;
  }
}

TEST(PlatformCpu, FloorIsTheLibrarys) {
  for (const float x : nasty_numbers()) expect_same(pt::floorf(x), std::floor(x), x, x);
}

TEST(PlatformCpu, LargerAndSmallerAreTheLibrarys) {
  const std::vector<float> numbers = nasty_numbers();
  for (const float a : numbers) {
    for (const float b : numbers) {
      if (a == 0.0f && b == 0.0f) continue;  // either zero is right
      expect_same(pt::fmaxf(a, b), std::fmax(a, b), a, b);
      expect_same(pt::fminf(a, b), std::fmin(a, b), a, b);
    }
  }
}

}  // namespace
}  // namespace pt
